#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/core/Principal.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {
namespace {

constexpr double E = 18.3e6, nu = 0.27;
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
constexpr int xx = 0, yy = 1, zz = 2, xy = 3;

using Constants = MohrCoulombParameters;

Constants constants(double phi, double psi, double c) {
  return {.elastic = {.youngs_modulus = E, .poisson_ratio = nu, .density = 1630.0},
          .friction_angle = phi,
          .dilation_angle = psi,
          .cohesion = c};
}

const Constants usual = constants(33.0, 11.0, 2.4e3);
const std::vector<Constants> many{usual, constants(33.0, 33.0, 2.4e3), constants(38.0, 0.0, 0.0),
                                  constants(25.0, 9.0, 0.0), constants(0.0, 0.0, 7e3)};

double N(double angle_degrees) {
  const double sine = std::sin(angle_degrees * std::numbers::pi / 180.0);
  return (1 + sine) / (1 - sine);
}

double compressive_strength(const Constants& k) {
  return 2 * k.cohesion * std::sqrt(N(k.friction_angle));
}

/// Smallest principal stress, tension positive, that the largest one can hold.
double strength(const Constants& k, double largest) {
  return N(k.friction_angle) * largest - compressive_strength(k);
}

SymmetricTensor isotropic(double value) {
  return {{value, value, value, 0, 0, 0}};
}

/// One particle driven by strain increments.
struct Point {
  const MohrCoulomb* law;
  SymmetricTensor stress;
  double plastic_strain = 0.0;

  void strain_by(const SymmetricTensor& increment) {
    Batch batch;
    batch.size = 1;
    for (std::size_t k = 0; k < 6; ++k) {
      batch.strain_increment.component[k] = &increment.components[k];
      batch.stress.component[k] = &stress.components[k];
    }
    batch.state = {&plastic_strain};
    law->update_stress(batch);
  }
};

SymmetricTensor hooke(const SymmetricTensor& strain) {
  return 2 * mu * strain + lambda * trace(strain) * isotropic(1.0);
}

SymmetricTensor compliance(const SymmetricTensor& stress) {
  return (1 + nu) / E * stress + (-nu / E * trace(stress)) * isotropic(1.0);
}

SymmetricTensor random_tensor(std::mt19937& random, double size) {
  std::normal_distribution<double> normal;
  SymmetricTensor a;
  for (double& component : a.components) component = size * normal(random);
  return a;
}

// Element tests ----------------------------------------------------------------------------------

/// Strains the axis yy and finds the lateral strain that leaves the lateral stress as it is. On an
/// edge only their sum counts, so both sides get the same. Returns the volumetric strain.
double triaxial_step(Point& point, double axial) {
  const double held = point.stress[xx];
  double low = -3 * std::abs(axial), high = -low;
  Point end = point;
  for (int k = 0; k < 100; ++k) {
    const double lateral = 0.5 * (low + high);
    end = point;
    end.strain_by({{lateral, axial, lateral, 0, 0, 0}});
    (end.stress[xx] < held ? low : high) = lateral;
  }
  point = end;
  return axial + low + high;
}

TEST(MohrCoulomb, triaxial_compression_is_elastic_then_fails_on_the_edge) {
  for (const Constants& k : many) {
    const MohrCoulomb law(k);
    Point point{&law, isotropic(-60e3)};
    EXPECT_NEAR(triaxial_step(point, -2e-4), -2e-4 * (1 - 2 * nu), 1e-12);
    EXPECT_NEAR(point.stress[yy], -60e3 - 2e-4 * E, 1e-4);
    EXPECT_EQ(point.plastic_strain, 0.0);

    for (int step = 0; step < 20; ++step) triaxial_step(point, -2e-3);
    EXPECT_NEAR(point.stress[yy], strength(k, -60e3), 1e-3);
    EXPECT_NEAR(point.stress[zz], -60e3, 1e-3);
    EXPECT_NEAR(triaxial_step(point, -3e-4), 3e-4 * (N(k.dilation_angle) - 1), 1e-11);
  }
}

TEST(MohrCoulomb, triaxial_compression_test_ends_at_the_strength_of_the_edge) {
  for (const Constants& k : many)
    for (double p : {40e3, 170e3}) {
      const MohrCoulomb law(k);
      const auto rows =
          run_element_test(law, {.confining_pressure = p, .strain_end = 0.06, .increments = 60});
      const double q = (N(k.friction_angle) - 1) * p + compressive_strength(k);
      EXPECT_NEAR(rows.back().q / q, 1.0, 1e-6);
      EXPECT_NEAR(rows.back().stress[xx], -p, 1e-6 * p);
      EXPECT_NEAR(rows.back().stress[zz], -p, 1e-6 * p);
    }
}

TEST(MohrCoulomb, triaxial_extension_fails_on_the_other_edge) {
  for (const Constants& k : many) {
    const MohrCoulomb law(k);
    Point point{&law, isotropic(-60e3)};
    for (int step = 0; step < 20; ++step) triaxial_step(point, 2e-3);
    const double at_failure = (-60e3 + compressive_strength(k)) / N(k.friction_angle);
    EXPECT_NEAR(point.stress[yy], at_failure, 1e-3);
    EXPECT_NEAR(triaxial_step(point, 3e-4), 3e-4 * (1 - 1 / N(k.dilation_angle)), 1e-11);
  }
}

TEST(MohrCoulomb, plane_strain_fails_with_the_elastic_stress_out_of_plane) {
  for (const Constants& k : many) {
    const MohrCoulomb law(k);
    MaterialPoint point(law, 40e3);
    MixedIncrement increment;
    increment.control[xx] = Control::stress;
    increment.change[yy] = -0.03;
    point.apply(increment);
    EXPECT_NEAR(point.stress()[xx], -40e3, 1e-2);
    EXPECT_NEAR(point.stress()[yy], strength(k, -40e3), 1e-2);
    EXPECT_NEAR(point.stress()[zz], -40e3 + nu * (strength(k, -40e3) + 40e3), 1e-2);

    const double before = trace(point.strain());
    increment.change[yy] = -0.002;
    point.apply(increment);
    EXPECT_NEAR(trace(point.strain()) - before, 0.002 * (N(k.dilation_angle) - 1), 1e-8);
  }
}

TEST(MohrCoulomb, oedometer_loads_along_the_edge_once_it_yields) {
  const Constants k = constants(20.0, 7.0, 1.3e3);  // 1/N is above the elastic nu/(1 - nu)
  const MohrCoulomb law(k);
  const double start = 5e3, n = N(k.friction_angle), m = N(k.dilation_angle);
  const auto rows = run_element_test(law, {.kind = ElementTestKind::oedometer,
                                           .confining_pressure = start,
                                           .strain_end = 0.01,
                                           .increments = 100});
  const auto axial = [](const ElementTestRow& row) { return row.p + 2 * row.q / 3; };
  const auto lateral = [](const ElementTestRow& row) { return row.p - row.q / 3; };
  EXPECT_NEAR(axial(rows[1]), start + (lambda + 2 * mu) * 1e-4, 1e-6);
  EXPECT_NEAR(lateral(rows[1]), start + lambda * 1e-4, 1e-6);
  EXPECT_NEAR(axial(rows[100]), n * lateral(rows[100]) + compressive_strength(k), 1e-5);

  // dsigma_a = N dsigma_l with elastic strains de + G axially and -m G/2 laterally.
  const double G =
      (2 * mu - lambda * (n - 1)) / (lambda * (n - 1) * (1 - m) - 2 * mu * (1 + n * m / 2));
  const double slope = lambda * (1 + G * (1 - m)) + 2 * mu * (1 + G);
  EXPECT_NEAR((axial(rows[100]) - axial(rows[80])) / 0.002, slope, 1e-7 * slope);
}

TEST(MohrCoulomb, simple_shear_at_constant_volume_presses_by_dilating) {
  for (const Constants& k : many) {
    const MohrCoulomb law(k);
    const double p = 30e3, n = N(k.friction_angle), m = N(k.dilation_angle);
    const double at_yield = (compressive_strength(k) + (n - 1) * p) / (n + 1);
    const double shear = at_yield / (2 * mu), more = 0.004;
    const double multiplier =
        2 * mu * (n + 1) * more / ((n - 1) * (m - 1) * (lambda + mu) + (n + 1) * (m + 1) * mu);
    MaterialPoint point(law, p);
    MixedIncrement increment;
    increment.change[xy] = shear + more;
    point.apply(increment);
    const double pressing = multiplier * (m - 1);
    EXPECT_NEAR(point.stress()[xx], -p - (lambda + mu) * pressing, 1e-5 * p);
    EXPECT_NEAR(point.stress()[yy], -p - (lambda + mu) * pressing, 1e-5 * p);
    EXPECT_NEAR(point.stress()[zz], -p - lambda * pressing, 1e-5 * p);
    EXPECT_NEAR(point.stress()[xy], at_yield + 2 * mu * (more - multiplier * (m + 1) / 2),
                1e-5 * p);
    EXPECT_NEAR(*point.state("plastic_strain"),
                multiplier * std::sqrt(2.0 / 3 * (m * m + 1 - (m - 1) * (m - 1) / 3)), 1e-9);
  }
}

TEST(MohrCoulomb, friction_angle_zero_is_tresca) {
  const MohrCoulomb law(constants(0.0, 0.0, 7e3));
  Point sheared{&law, isotropic(-3e3)};
  sheared.strain_by({{0, 0, 0, 0.05, 0, 0}});
  EXPECT_NEAR(sheared.stress[xy], 7e3, 1e-8);
  Point pulled{&law, isotropic(0.0)};
  pulled.strain_by(isotropic(0.02));
  EXPECT_NEAR(pulled.stress[xx], (3 * lambda + 2 * mu) * 0.02, 1e-6);
}

TEST(MohrCoulomb, tension_ends_at_the_apex) {
  const MohrCoulomb law(usual);
  const double apex = 2.4e3 / std::tan(33.0 * std::numbers::pi / 180.0);
  for (const SymmetricTensor& shape :
       {isotropic(0.01), SymmetricTensor{{0.02, 0.013, 0.018, 0.001, -0.002, 0.0005}}}) {
    Point point{&law, isotropic(-5e3)};
    point.strain_by(shape);
    EXPECT_LT(norm(point.stress + (-1.0) * isotropic(apex)), 1e-8);
  }
  Point loose{&law, isotropic(0.0)};
  loose.strain_by(isotropic(0.01));
  EXPECT_NEAR(loose.plastic_strain, 0.0, 1e-15);  // no distortion
}

TEST(MohrCoulomb, sand_without_cohesion_carries_no_tension) {
  const MohrCoulomb law(constants(38.0, 0.0, 0.0));
  Point point{&law, isotropic(0.0)};
  point.strain_by({{0.002, -0.0007, 0.001, 0.0004, 0, 0}});
  EXPECT_LT(norm(point.stress), 1e-9);
  EXPECT_GT(point.plastic_strain, 1e-3);
}

// The return in general --------------------------------------------------------------------------

/// Hands `check` the law, the trial stress, and the point after thousands of increments, tiny and
/// huge, in directions at random.
template <class Check>
void after_random_increments(const Constants& k, int count, const Check& check) {
  const MohrCoulomb law(k);
  std::mt19937 random(20);
  std::uniform_real_distribution<double> exponent(-7.0, -1.0), squeeze(-1.0, 0.4);
  Point point{&law, isotropic(-20e3)};
  for (int step = 0; step < count; ++step) {
    const double size = std::pow(10.0, exponent(random));
    const SymmetricTensor increment =
        random_tensor(random, size) + size * squeeze(random) * isotropic(1.0);
    if (norm(point.stress) > 3e6) point.stress = isotropic(-20e3);
    const SymmetricTensor trial = point.stress + hooke(increment);
    const double plastic_strain = point.plastic_strain;
    point.strain_by(increment);
    check(law, trial, point, point.plastic_strain - plastic_strain);
  }
}

TEST(MohrCoulomb, no_increment_leaves_the_yield_surface) {
  for (const Constants& k : many) {
    int plastic = 0;
    after_random_increments(
        k, 5000, [&](const auto& law, const auto& trial, const auto& point, double growth) {
          const double f = law.yield_function(principal(point.stress).value);
          EXPECT_LE(f, 1e-9 * norm(point.stress) + 1e-14 * norm(trial));
          EXPECT_GE(growth, 0.0);
          if (growth > 0.0) ++plastic;
        });
    EXPECT_GT(plastic, 1500);
  }
}

/// Plastic strains flow along the potentials of the planes on which the stress ends, with
/// multipliers that are not negative: together with f = 0 this is what defines the return.
TEST(MohrCoulomb, plastic_strain_is_normal_to_the_potentials_that_are_active) {
  for (const Constants& k : many) {
    std::array<int, 4> regions{};
    after_random_increments(
        k, 5000, [&](const auto& law, const auto& trial, const auto& point, double) {
          const auto before = principal(trial).value;
          if (!(law.yield_function(before) > 0.0)) return;
          const auto after = principal(point.stress).value;
          const double size = norm(trial), same = 1e-9 * size;
          EXPECT_NEAR(law.yield_function(after), 0.0, same);
          const bool on_compression = after[0] - after[1] < same;
          const bool on_extension = after[1] - after[2] < same;
          ++regions[(on_compression ? 1U : 0U) + (on_extension ? 2U : 0U)];
          if (on_compression && on_extension) return;  // the apex lets every strain pass
          const SymmetricTensor removed{
              {before[0] - after[0], before[1] - after[1], before[2] - after[2], 0, 0, 0}};
          const SymmetricTensor strain = compliance(removed);
          const double tiny = 1e-8 * size / E, m = N(k.dilation_angle);
          EXPECT_GE(strain[0], -tiny);
          EXPECT_LE(strain[2], tiny);
          if (!on_compression) {
            EXPECT_LE(strain[1], tiny);
          }
          if (!on_extension) {
            EXPECT_GE(strain[1], -tiny);
          }
          const double opening = strain[0] + std::max(strain[1], 0.0);
          const double closing = strain[2] + std::min(strain[1], 0.0);
          EXPECT_NEAR(opening, -m * closing, 4 * m * tiny);
        });
    for (std::size_t region : {0U, 1U, 2U}) EXPECT_GT(regions[region], 20) << region;
    if (k.friction_angle > 0.0) {
      EXPECT_GT(regions[3], 20);
    }
  }
}

/// Hildreth's method for the stress closest to the trial in energy below all six planes, without
/// knowing of edges or apex.
std::array<double, 3> closest_point(const Constants& k, std::array<double, 3> stress) {
  const double n = N(k.friction_angle);
  const double stiffness = lambda * (n - 1) * (n - 1) + 2 * mu * (n * n + 1);
  std::array<double, 6> multiplier{};
  for (int sweep = 0; sweep < 20000; ++sweep)
    for (std::size_t plane = 0; plane < 6; ++plane) {
      const std::size_t i = plane % 3, j = (i + 1 + plane / 3) % 3;
      const double f = n * stress[i] - stress[j] - compressive_strength(k);
      const double change = std::max(-multiplier[plane], f / stiffness);
      multiplier[plane] += change;
      for (double& component : stress) component -= lambda * (n - 1) * change;
      stress[i] -= 2 * mu * n * change;
      stress[j] += 2 * mu * change;
    }
  return stress;
}

TEST(MohrCoulomb, associated_return_is_the_closest_point_in_energy) {
  for (const Constants& k : {constants(33.0, 33.0, 2.4e3), constants(0.0, 0.0, 7e3)}) {
    int compared = 0;
    after_random_increments(
        k, 400, [&](const auto& law, const auto& trial, const auto& point, double) {
          const auto before = principal(trial).value;
          if (!(law.yield_function(before) > 0.0) || compared == 60) return;
          ++compared;
          const auto after = principal(point.stress).value, closest = closest_point(k, before);
          for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(after[i], closest[i], 1e-8 * norm(trial));
        });
    EXPECT_EQ(compared, 60);
  }
}

/// Also against stresses with other principal axes.
TEST(MohrCoulomb, associated_flow_dissipates_most) {
  const Constants k = constants(33.0, 33.0, 2.4e3);
  std::mt19937 random(5);
  after_random_increments(
      k, 2000, [&](const auto& law, const auto& trial, const auto& point, double) {
        const SymmetricTensor plastic = compliance(trial + (-1.0) * point.stress);
        SymmetricTensor other =
            point.stress + random_tensor(random, 0.3 * norm(point.stress) + 1e3);
        const SymmetricTensor inside = isotropic(-norm(other));
        while (law.yield_function(principal(other).value) > 0.0) other = 0.5 * (other + inside);
        // Where nothing yields `plastic` is the round-off of the elastic strain.
        const double round_off = 1e-12 * norm(plastic) + 1e-14 * norm(compliance(trial));
        EXPECT_GE(contract(point.stress + (-1.0) * other, plastic), -norm(trial) * round_off);
      });
}

using Rotation = std::array<Vector<3>, 3>;

SymmetricTensor turned(const SymmetricTensor& a, const Rotation& axes) {
  const Principal p = principal(a);
  Principal q{p.value, {}};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t d = 0; d < 3; ++d)
      for (std::size_t e = 0; e < 3; ++e) q.axis[i][d] += axes[d][e] * p.axis[i][e];
  return compose(q);
}

void turns_with_its_input(const Rotation& axes) {
  for (const Constants& k : many) {
    const MohrCoulomb law(k);
    std::mt19937 random(3);
    for (int step = 0; step < 300; ++step) {
      const SymmetricTensor strain = random_tensor(random, 2e-3);
      const SymmetricTensor start = isotropic(-20e3) + random_tensor(random, 2e3);
      Point point{&law, start}, other{&law, turned(start, axes)};
      point.strain_by(strain);
      other.strain_by(turned(strain, axes));
      EXPECT_LT(norm(other.stress + (-1.0) * turned(point.stress, axes)), 1e-6);
      EXPECT_NEAR(other.plastic_strain, point.plastic_strain, 1e-12);
    }
  }
}

TEST(MohrCoulomb, stress_turns_with_the_strain) {
  turns_with_its_input(principal({{1.0, 2.0, 3.5, 0.4, -0.7, 1.1}}).axis);
}

TEST(MohrCoulomb, knows_no_order_of_the_axes) {
  turns_with_its_input({{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}});
  turns_with_its_input({{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}});
}

TEST(MohrCoulomb, plane_strain_may_leave_components_out) {
  const MohrCoulomb law(usual);
  Point full{&law, isotropic(-9e3)};
  const SymmetricTensor strain{{1e-3, -2e-3, 0.0, 3e-3, 0.0, 0.0}};
  std::array<double, 4> stress{-9e3, -9e3, -9e3, 0.0};
  double plastic_strain = 0.0;
  Batch batch;
  batch.size = 1;
  for (std::size_t k = 0; k < 4; ++k) {
    batch.strain_increment.component[k] = &strain.components[k];
    batch.stress.component[k] = &stress[k];
  }
  batch.state = {&plastic_strain};
  law.update_stress(batch);
  full.strain_by(strain);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(stress[static_cast<std::size_t>(k)], full.stress[k]);
  EXPECT_EQ(plastic_strain, full.plastic_strain);
}

TEST(MohrCoulomb, hands_on_what_is_not_a_number) {
  const MohrCoulomb law(usual);
  Point point{&law, isotropic(-1e3)};
  point.strain_by(isotropic(std::nan("")));
  EXPECT_TRUE(std::isnan(trace(point.stress)));
}

// The start, limits and options ------------------------------------------------------------------

/// Text of the refusal of an initial stress, empty where it is accepted.
std::string refusal(const Constants& k, SymmetricTensor stress) {
  const MohrCoulomb law(k);
  double plastic_strain = 0.3;
  Batch batch;
  batch.size = 1;
  for (std::size_t c = 0; c < 6; ++c) batch.stress.component[c] = &stress.components[c];
  batch.state = {&plastic_strain};
  try {
    law.initialise_from_stress(batch);
  } catch (const BadInput& error) {
    return error.what();
  }
  EXPECT_EQ(plastic_strain, 0.0);
  return "";
}

TEST(MohrCoulomb, starts_from_every_stress_that_it_carries_and_no_other) {
  const double limit = strength(usual, -10e3);
  EXPECT_EQ(refusal(usual, {{-10e3, limit, -15e3, 0, 0, 0}}), "");
  const std::string text = refusal(usual, {{-10e3, 1.001 * limit, -15e3, 0, 0, 0}});
  EXPECT_NE(text.find("-mohr_coulomb_friction_angle 33"), std::string::npos) << text;
  EXPECT_NE(text.find("-mohr_coulomb_cohesion 2400"), std::string::npos) << text;
  EXPECT_EQ(refusal(usual, isotropic(3.6e3)), "");
  EXPECT_NE(refusal(usual, isotropic(3.8e3)), "");  // beyond the apex
  EXPECT_NE(refusal(usual, isotropic(std::nan(""))), "");
}

TEST(MohrCoulomb, counts_particles_at_the_apex) {
  const MohrCoulomb law(usual);
  const double apex = 2.4e3 / std::tan(33.0 * std::numbers::pi / 180.0);
  std::array<double, 3> normal{apex, 0.99 * apex, -5e3};
  Batch batch;
  batch.size = 3;
  for (std::size_t k = 0; k < 3; ++k) batch.stress.component[k] = normal.data();
  EXPECT_EQ(law.count_at_limits(batch), 1U);
  EXPECT_EQ(MohrCoulomb(constants(0.0, 0.0, 7e3)).count_at_limits(batch), 0U);
}

TEST(MohrCoulomb, knows_its_density_and_its_wave_modulus) {
  const MohrCoulomb law(usual);
  std::array<double, 2> modulus{};
  Batch batch;
  batch.size = 2;
  law.wave_modulus(batch, modulus);
  EXPECT_NEAR(modulus[1], lambda + 2 * mu, 1e-6);
  EXPECT_EQ(law.initial_density(), 1630.0);
}

TEST(MohrCoulomb, refuses_constants_that_make_no_sense) {
  EXPECT_THROW(MohrCoulomb(constants(90.0, 0.0, 1e3)), BadInput);
  EXPECT_THROW(MohrCoulomb(constants(-1.0, 0.0, 1e3)), BadInput);
  EXPECT_THROW(MohrCoulomb(constants(30.0, 31.0, 1e3)), BadInput);
  EXPECT_THROW(MohrCoulomb(constants(30.0, -1.0, 1e3)), BadInput);
  EXPECT_THROW(MohrCoulomb(constants(30.0, 2.0, -1.0)), BadInput);
  EXPECT_THROW(MohrCoulomb(constants(0.0, 0.0, 0.0)), BadInput);
  try {
    const MohrCoulomb refused({.elastic = {.youngs_modulus = -3.0}});
    FAIL() << "accepted";
  } catch (const BadInput& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("-mohr_coulomb_youngs_modulus -3"), std::string::npos) << text;
  }
}

TEST(MohrCoulombFactory, builds_the_law_that_the_options_describe) {
  options::OptionSet set;
  MohrCoulombFactory factory;
  factory.declare(set);
  const std::vector<options::Given> given{{"mohr_coulomb_youngs_modulus", "18.3e6", "test"},
                                          {"mohr_coulomb_poisson_ratio", "0.27", "test"},
                                          {"mohr_coulomb_density", "1630", "test"},
                                          {"mohr_coulomb_friction_angle", "33", "test"},
                                          {"mohr_coulomb_dilation_angle", "11", "test"},
                                          {"mohr_coulomb_cohesion", "2400", "test"}};
  set.assign(given);
  const auto made = factory.create();
  const MohrCoulomb expected(usual);
  EXPECT_EQ(made->initial_density(), 1630.0);
  Point a{&dynamic_cast<const MohrCoulomb&>(*made), isotropic(-8e3)}, b{&expected, a.stress};
  const SymmetricTensor strain{{4e-3, -3e-3, 1e-3, 2e-3, 0, 0}};
  a.strain_by(strain);
  b.strain_by(strain);
  EXPECT_EQ(a.stress.components, b.stress.components);
}

}  // namespace
}  // namespace mpm::material
