#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/VonMises.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {
namespace {

constexpr double E = 6.4e6, nu = 0.31, c = 13.7e3;
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
constexpr double yield_stress = std::numbers::sqrt3 * c;
constexpr int xx = 0, yy = 1, zz = 2, xy = 3;

const VonMisesParameters clay{
    .elastic = {.youngs_modulus = E, .poisson_ratio = nu, .density = 1740.0}, .shear_strength = c};
const VonMises law(clay);

SymmetricTensor isotropic(double value) {
  return {{value, value, value, 0, 0, 0}};
}

double q_of(const SymmetricTensor& stress) {
  return std::sqrt(1.5) * norm(deviator(stress));
}

/// One particle driven by strain increments.
struct Point {
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
    law.update_stress(batch);
  }
};

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

TEST(VonMises, triaxial_tests_are_elastic_then_end_at_sqrt_3_times_the_strength) {
  for (const auto kind :
       {ElementTestKind::triaxial_compression, ElementTestKind::triaxial_extension}) {
    const auto rows = run_element_test(
        law, {.kind = kind, .confining_pressure = 90e3, .strain_end = 0.02, .increments = 40});
    EXPECT_NEAR(rows[4].q, E * 0.002, 1e-3);
    EXPECT_NEAR(rows[40].q, yield_stress, 1e-4);
    const double elastic_change = (1 - 2 * nu) * yield_stress / E;
    EXPECT_NEAR(std::abs(rows[40].volumetric_strain), elastic_change, 1e-8);
  }
}

TEST(VonMises, simple_shear_ends_at_the_strength) {
  Point point{isotropic(-50e3)};
  const double at_yield = c / (2 * mu);
  point.strain_by({{0, 0, 0, 0.9 * at_yield, 0, 0}});
  EXPECT_NEAR(point.stress[xy], 0.9 * c, 1e-8);
  EXPECT_EQ(point.plastic_strain, 0.0);
  point.strain_by({{0, 0, 0, 1.8 * at_yield, 0, 0}});
  EXPECT_NEAR(point.stress[xy], c, 1e-8);
  EXPECT_NEAR(point.plastic_strain, 1.7 * at_yield * 2 / std::numbers::sqrt3, 1e-12);
}

/// As Prandtl's footing needs it. At first yield it is another value, since the stress out of
/// plane is elastic.
TEST(VonMises, plane_strain_compression_ends_at_twice_the_strength) {
  MaterialPoint point(law, 90e3);
  MixedIncrement increment;
  increment.control[xx] = Control::stress;
  increment.change[yy] = -0.06;
  point.apply(increment);
  EXPECT_NEAR(point.stress()[xx] - point.stress()[yy], 2 * c, 1e-6 * c);
  EXPECT_NEAR(point.stress()[zz], 0.5 * (point.stress()[xx] + point.stress()[yy]), 1e-3 * c);
  EXPECT_NEAR(trace(point.strain()) - trace(compliance(point.stress() + isotropic(90e3))), 0.0,
              1e-9);
}

TEST(VonMises, strength_does_not_depend_on_pressure) {
  const SymmetricTensor strain{{2e-3, -7e-3, 1e-3, 4e-3, -2e-3, 3e-3}};
  Point low{isotropic(-1e3)}, high{isotropic(-900e3)}, pulled{isotropic(60e3)};
  for (Point* point : {&low, &high, &pulled}) {
    const double mean = trace(point->stress);
    point->strain_by(strain);
    EXPECT_NEAR(trace(point->stress) - mean, (3 * lambda + 2 * mu) * trace(strain), 1e-6);
    EXPECT_LT(norm(deviator(point->stress) + (-1.0) * deviator(low.stress)), 1e-6);
    EXPECT_NEAR(point->plastic_strain, low.plastic_strain, 1e-12);
  }
}

// The return
// ---------------------------------------------------------------------------------------

TEST(VonMises, no_increment_leaves_the_yield_surface_and_none_gains_work) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-7.0, -1.0);
  Point point{isotropic(-20e3)};
  int plastic = 0;
  for (int step = 0; step < 5000; ++step) {
    const SymmetricTensor increment = random_tensor(random, std::pow(10.0, exponent(random)));
    const Point before = point;
    point.strain_by(increment);
    const double growth = point.plastic_strain - before.plastic_strain;
    EXPECT_LE(q_of(point.stress), yield_stress * (1 + 1e-9));
    EXPECT_GE(growth, 0.0);
    const SymmetricTensor plastic_part =
        increment + (-1.0) * compliance(point.stress + (-1.0) * before.stress);
    EXPECT_NEAR(contract(point.stress, plastic_part), yield_stress * growth,
                1e-11 * norm(point.stress) * norm(increment) + 1e-12 * c);
    if (growth > 0.0) ++plastic;
  }
  EXPECT_GT(plastic, 1500);
}

/// Krieg & Krieg (1977): on the yield surface a constant strain rate of size |de| turns the stress
/// deviator towards itself, tan(angle/2) shrinking by exp(-2 G |de|/|s|).
SymmetricTensor exact_deviator(const SymmetricTensor& start, const SymmetricTensor& strain) {
  const double radius = norm(start), length = norm(strain);
  const SymmetricTensor along = 1 / length * strain;
  const double cosine = contract(start, along) / radius;
  const SymmetricTensor across = 1 / radius * start + (-cosine) * along;
  const double angle =
      2 * std::atan(std::tan(0.5 * std::acos(cosine)) * std::exp(-2 * mu * length / radius));
  return radius * (std::cos(angle) * along + std::sin(angle) / norm(across) * across);
}

TEST(VonMises, path_that_bends_converges_to_the_solution_of_krieg_and_krieg) {
  const SymmetricTensor first{{0, 0, 0, 0.01, 0, 0}};
  const SymmetricTensor bend{{0.0021, -0.0013, -0.0008, 0.0003, 0.0014, 0.0007}};
  Point start{isotropic(-30e3)};
  start.strain_by(first);
  const SymmetricTensor exact = exact_deviator(deviator(start.stress), bend);
  EXPECT_GT(norm(exact + (-1.0) * deviator(start.stress)), c);  // it does bend
  const auto error = [&](int parts) {
    Point point = start;
    for (int k = 0; k < parts; ++k) point.strain_by(1.0 / parts * bend);
    return norm(deviator(point.stress) + (-1.0) * exact) / c;
  };
  EXPECT_LT(error(1), 0.12);
  EXPECT_LT(error(3000), 1e-4);
  EXPECT_NEAR(error(500) / error(1000), 2.0, 0.02);
}

TEST(VonMises, straight_path_is_exact_in_one_increment) {
  const SymmetricTensor strain{{0.011, -0.007, -0.004, 0.006, -0.003, 0.002}};
  Point once{isotropic(-30e3)}, often = once;
  once.strain_by(strain);
  for (int k = 0; k < 1000; ++k) often.strain_by(1e-3 * strain);
  EXPECT_LT(norm(once.stress + (-1.0) * often.stress), 1e-6);
  EXPECT_NEAR(once.plastic_strain, often.plastic_strain, 1e-12);
  const SymmetricTensor expected = std::numbers::sqrt2 * c / norm(strain) * strain;
  EXPECT_LT(norm(deviator(once.stress) + (-1.0) * expected), 1e-6);
}

TEST(VonMises, hands_on_what_is_not_a_number) {
  Point point{isotropic(-1e3)};
  point.strain_by(isotropic(std::nan("")));
  EXPECT_TRUE(std::isnan(trace(point.stress)));
}

// The start and the options
// ------------------------------------------------------------------------

TEST(VonMises, gives_the_same_bits_in_a_batch_of_any_size) {
  constexpr std::size_t most = 9;
  std::array<std::array<double, most>, 6> strain{}, start{};
  std::mt19937 generator(31);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < 6; ++k)
    for (std::size_t p = 0; p < most; ++p) {
      strain[k][p] = 1e-3 * normal(generator);
      start[k][p] = 0.4 * c * normal(generator);
    }
  const auto update = [&](std::size_t first, std::size_t size, auto& stress, auto& plastic) {
    Batch batch;
    batch.size = size;
    for (std::size_t k = 0; k < 6; ++k) {
      batch.strain_increment.component[k] = &strain[k][first];
      batch.stress.component[k] = &stress[k][first];
    }
    batch.state = {&plastic[first]};
    law.update_stress(batch);
  };
  auto alone = start;
  std::array<double, most> plastic_alone{};
  for (std::size_t p = 0; p < most; ++p) update(p, 1, alone, plastic_alone);
  for (std::size_t size = 1; size <= most; ++size) {
    auto together = start;
    std::array<double, most> plastic{};
    update(0, size, together, plastic);
    for (std::size_t p = 0; p < most; ++p) {
      EXPECT_EQ(plastic[p], p < size ? plastic_alone[p] : 0.0);
      for (std::size_t k = 0; k < 6; ++k)
        EXPECT_EQ(together[k][p], (p < size ? alone : start)[k][p]) << size;
    }
  }
  EXPECT_GT(std::ranges::count_if(plastic_alone, [](double x) { return x > 0.0; }), 2);
}

TEST(VonMises, starts_from_every_stress_that_it_carries_and_no_other) {
  SymmetricTensor stress{{-20e3, -20e3, -20e3 - yield_stress, 0, 0, 0}};
  double plastic_strain = 0.4;
  Batch batch;
  batch.size = 1;
  for (std::size_t k = 0; k < 6; ++k) batch.stress.component[k] = &stress.components[k];
  batch.state = {&plastic_strain};
  law.initialise_from_stress(batch);
  EXPECT_EQ(plastic_strain, 0.0);
  stress[zz] -= 0.001 * yield_stress;
  try {
    law.initialise_from_stress(batch);
    FAIL() << "accepted";
  } catch (const BadInput& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("-von_mises_shear_strength 13700"), std::string::npos) << text;
  }
}

TEST(VonMises, knows_its_density_and_its_wave_modulus) {
  std::array<double, 2> modulus{};
  Batch batch;
  batch.size = 2;
  law.wave_modulus(batch, modulus);
  EXPECT_NEAR(modulus[1], lambda + 2 * mu, 1e-6);
  EXPECT_EQ(law.initial_density(), 1740.0);
}

TEST(VonMises, refuses_constants_that_make_no_sense) {
  VonMisesParameters weak = clay;
  weak.shear_strength = 0.0;
  EXPECT_THROW(VonMises{weak}, BadInput);
  VonMisesParameters unstable = clay;
  unstable.elastic.poisson_ratio = 0.5;
  try {
    const VonMises refused(unstable);
    FAIL() << "accepted";
  } catch (const BadInput& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("-von_mises_poisson_ratio 0.5"), std::string::npos) << text;
  }
}

TEST(VonMisesFactory, builds_the_law_that_the_options_describe) {
  options::OptionSet set;
  VonMisesFactory factory;
  factory.declare(set);
  const std::vector<options::Given> given{{"von_mises_youngs_modulus", "6.4e6", "test"},
                                          {"von_mises_poisson_ratio", "0.31", "test"},
                                          {"von_mises_density", "1740", "test"},
                                          {"von_mises_shear_strength", "13.7e3", "test"}};
  set.assign(given);
  const auto made = factory.create();
  EXPECT_EQ(made->initial_density(), 1740.0);
  const auto rows = run_element_test(*made, {.kind = ElementTestKind::triaxial_compression,
                                             .confining_pressure = 5e3,
                                             .strain_end = 0.02,
                                             .increments = 20});
  EXPECT_NEAR(rows[1].q, E * 0.001, 1e-3);
  EXPECT_NEAR(rows.back().q, yield_stress, 1e-4);
}

}  // namespace
}  // namespace mpm::material
