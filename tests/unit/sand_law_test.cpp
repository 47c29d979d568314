#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/SandLaw.hpp"
#include "support/SandParticle.hpp"
#include "support/SandReadings.hpp"

namespace mpm::material {
namespace {

double friction_angle_deg(double eta) {
  return std::asin(3.0 * eta / (6.0 + eta)) * 180.0 / std::numbers::pi;
}

double peak_stress_ratio(const std::vector<ElementTestRow>& rows) {
  double peak = 0.0;
  for (const ElementTestRow& row : rows) peak = std::max(peak, row.q / row.p);
  return peak;
}

// The surface ------------------------------------------------------------------------------------

class EveryReading : public ::testing::TestWithParam<std::size_t> {
 protected:
  static SandParameters sand() {
    SandParameters sand = sand_with(0.6, 0.0);
    sand_readings.at(GetParam()).choose(sand);
    return sand;
  }
};

double central_difference(const LoadingSurface& surface, SurfaceState y,
                          double SurfaceState::*argument, double step) {
  SurfaceState below = y;
  y.*argument += step;
  below.*argument -= step;
  return (surface.at(y).qhat - surface.at(below).qhat) / (2.0 * step);
}

TEST_P(EveryReading, slopes_are_the_derivatives_of_qhat) {
  const LoadingSurface surface(sand());
  for (double p : {1.3e3, 40e3, 900e3})
    for (double e : {0.45, 0.61, 0.79})
      for (double eps : {2e-4, 0.013, 0.21})
        for (double t : {-0.97, -0.1, 0.8}) {
          const SurfaceState y{p, e, eps, t};
          const auto [C, E, F, T] = surface.slopes(y, surface.at(y));
          const auto difference = [&](double SurfaceState::*argument, double step) {
            return central_difference(surface, y, argument, step);
          };
          EXPECT_NEAR(C, difference(&SurfaceState::p_star, 1e-4 * p), 1e-6);
          EXPECT_NEAR(E, difference(&SurfaceState::void_ratio, 1e-5), 1e-6 * p);
          EXPECT_NEAR(F, difference(&SurfaceState::eps_q, 1e-4 * eps), 1e-6 * surface.at(y).G);
          EXPECT_NEAR(T, difference(&SurfaceState::sin3theta, 1e-5), 1e-6 * p);
        }
}

/// h - f D p* of Eq. 12 with the q that is claimed to solve it.
double right_hand_side(const SandParameters& sand, const SurfaceState& y, double M, double q) {
  const auto [p, e, eps, sin3theta] = y;
  const double G =
      sand.G0 * std::pow(2.973 - sand.void_ratio, 2) / (1 + sand.void_ratio) * std::sqrt(p * 101e3);
  const double e_c = sand.xi ? sand.e_Gamma - sand.lambda_c * std::pow(p / 101e3, *sand.xi)
                             : sand.e_Gamma - sand.lambda_c * std::log(p / 1e3);
  const double h = eps / (1 / (3 * G) + eps / (M * p));
  const double x = eps / sand.eps_r;
  const double f = x * std::exp(sand.softening == Softening::plain ? -x : 1 - x);
  const double eta = (sand.softening == Softening::explicit_ratio ? h : q) / p;
  const double D = sand.d0 * std::exp(sand.m * (e - e_c)) - sand.d0 * eta / M;
  return h - f * (sand.dilatancy == Dilatancy::lode ? M / sand.Mc : 1.0) * D * p;
}

TEST_P(EveryReading, qhat_solves_the_stress_strain_relation) {
  const SandParameters sand = EveryReading::sand();
  for (double sin3theta : {-1.0, -0.3, 0.9}) {
    const SurfaceState y{37e3, 0.58, 0.034, sin3theta};
    const SurfacePoint point = LoadingSurface(sand).at(y);
    EXPECT_NEAR(point.qhat, right_hand_side(sand, y, point.M, point.qhat), 1e-9 * y.p_star);
  }
}

TEST_P(EveryReading, factors_nearby_are_those_of_the_state_itself) {
  const LoadingSurface surface(sand());
  const SurfaceState y{37e3, 0.58, 0.034, -0.3};
  const SurfaceState near{y.p_star * 1.01, y.void_ratio - 1e-3, y.eps_q + 7e-4, -0.3};
  const SurfaceChange<double> change{0.01, -1e-3, 7e-4};
  const SurfaceFactors<double> before = surface.factors(y);
  ASSERT_TRUE(surface.is_nearby(change, before.critical_slope));
  const auto now = surface.factors_nearby(near, before, change), exact = surface.factors(near);
  EXPECT_NEAR(now.psi, exact.psi, 1e-15);
  EXPECT_NEAR(now.A, exact.A, 1e-14 * exact.A);
  EXPECT_NEAR(now.decay, exact.decay, 1e-14 * exact.decay);
  EXPECT_NEAR(now.critical_slope, exact.critical_slope, 1e-14 * exact.critical_slope);
  EXPECT_NEAR(now.stiffness, exact.stiffness, 1e-14 * exact.stiffness);
}

TEST_P(EveryReading, short_elastic_paths_are_those_of_the_closed_form) {
  const LoadingSurface surface(sand());
  const SandElasticity& elasticity = surface.elasticity();
  for (double p : {30.0, 7e3, 1.3e6})
    for (double change : {-0.03, -1e-5, 1e-9, 2e-3, 0.031}) {
      const double strain = change / elasticity.stiffness(p);
      const auto end = elasticity.follow(p, strain);
      const auto little =
          elasticity.follow_little(p, elasticity.shear_modulus(p), elasticity.stiffness(p), strain);
      EXPECT_NEAR(little.p_star, end.p_star, 1e-13 * p);
      EXPECT_NEAR(little.mean_shear_modulus, end.mean_shear_modulus,
                  1e-12 * end.mean_shear_modulus);
    }
}

INSTANTIATE_TEST_SUITE_P(SandSurface, EveryReading,
                         ::testing::Range<std::size_t>(0, sand_readings.size()),
                         [](const auto& instance) { return name_of_reading(instance.param); });

TEST(SandSurface, free_of_the_lode_angle_the_limit_of_strength_is_alike_at_every_angle) {
  SandParameters sand = sand_with(0.524, 0.0);
  sand.dilatancy = Dilatancy::lode;
  const LoadingSurface surface(sand);
  const auto ratio = [&](double sin3theta) {
    const SurfaceState y{5e3, 0.55, sand.eps_r, sin3theta};
    return surface.at(y).qhat / surface.at(y).M;
  };
  // What is left is the rise of h, which is steeper where M is smaller.
  EXPECT_NEAR(ratio(1.0) / ratio(-1.0), 1.0, 0.01);
  sand.dilatancy = Dilatancy::printed;
  const LoadingSurface printed(sand);
  const auto s = [&](double sin3theta) {
    return printed.at<double>({5e3, 0.55, 0.06, sin3theta}).s;
  };
  EXPECT_GT(s(1.0) / s(-1.0), 1.2);
}

TEST(SandSurface, critical_stress_ratio_follows_the_lode_angle) {
  const SandParameters sand;
  const LoadingSurface surface(sand);
  const auto ratio = [&](double t) { return surface.at({5e3, 0.6, 0.01, t}).M / sand.Mc; };
  EXPECT_NEAR(ratio(-1.0), 1.0, 1e-14);
  EXPECT_NEAR(ratio(1.0), sand.c, 1e-14);
  EXPECT_NEAR(ratio(0.0), sand.c * (1 + sand.c) / (1 + sand.c * sand.c), 1e-14);
}

TEST(SandSurface, capped_state_parameter_takes_its_slopes_away) {
  const SandParameters sand;
  const LoadingSurface surface(sand);
  const SurfaceState loose{40e3, 0.98, 0.03, -0.4};
  EXPECT_TRUE(surface.is_capped(surface.at(loose)));
  EXPECT_EQ(surface.slopes(loose, surface.at(loose)).E, 0.0);
  EXPECT_NEAR(surface.slopes(loose, surface.at(loose)).C,
              central_difference(surface, loose, &SurfaceState::p_star, 4.0), 1e-7);
}

TEST(SandSurface, strength_is_never_negative) {
  SandParameters sand;
  sand.psi_cap = 1.0;
  EXPECT_EQ(LoadingSurface(sand).at({40e3, 1.3, 0.06, 0.9}).qhat, 0.0);
}

using enum ElementTestKind;

TEST(SandLaw, peak_friction_angle_tells_the_softening_readings_apart) {
  const auto peak_angle = [](Softening softening, double void_ratio, double pressure) {
    SandParameters sand = sand_with(void_ratio, 0.0);
    sand.softening = softening;
    const auto rows = run_element_test(
        SandLaw(sand), {.confining_pressure = pressure, .strain_end = 0.2, .increments = 400});
    return friction_angle_deg(peak_stress_ratio(rows));
  };
  EXPECT_NEAR(peak_angle(Softening::normalized, 0.551, 150e3), 37.7, 0.1);
  EXPECT_NEAR(peak_angle(Softening::normalized, 0.574, 500e3), 34.9, 0.1);
  EXPECT_NEAR(peak_angle(Softening::plain, 0.551, 150e3), 32.6, 0.1);
  EXPECT_NEAR(peak_angle(Softening::plain, 0.574, 500e3), 31.7, 0.1);
}

class CriticalState : public ::testing::TestWithParam<double> {};

TEST_P(CriticalState, is_reached_at_logarithmic_strain_two) {
  const SandParameters sand = sand_with(GetParam(), 0.0);
  const SandLaw law(sand);
  for (ElementTestKind kind : {triaxial_compression, triaxial_extension, plane_strain}) {
    const auto row =
        run_element_test(
            law, {.kind = kind, .confining_pressure = 200e3, .strain_end = 2.0, .increments = 1000})
            .back();
    const double sin3theta = std::sin(3.0 * row.lode_angle_deg * std::numbers::pi / 180.0);
    const double M = law.surface().at({row.p, row.void_ratio, 2.0, sin3theta}).M;
    EXPECT_NEAR(row.q / row.p / M, 1.0, 1e-3);
    EXPECT_NEAR(row.void_ratio, law.surface().critical_void_ratio(row.p), 2e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(SandLaw, CriticalState, ::testing::Values(0.524, 0.657, 0.75));

// Loading, unloading -----------------------------------------------------------------------------

TEST(SandLaw, stays_on_the_loading_surface_while_the_lode_angle_turns) {
  const SandLaw law(sand_with(0.58, 1000.0));
  Particle particle(law, at_rest(30e3, 0.5));
  for (int k = 0; k < 3000; ++k) {
    const double turn = 1e-3 * k;
    const double eps_q = particle.eps_q();
    particle.strain_by(2e-5 * SymmetricTensor{{0.3 + std::sin(turn), -1.0, 0.4 - std::sin(turn),
                                               std::sin(2 * turn), 0.3 * turn, -0.2}});
    ASSERT_GT(particle.eps_q(), eps_q);
    ASSERT_NEAR(particle.q(), particle.qhat(), 1e-8 * particle.p_star()) << "step " << k;
  }
}

TEST(SandLaw, is_never_outside_the_loading_surface) {
  std::mt19937 generator(7);
  for (double size : {1e-6, 3e-5, 1e-3}) {
    const SandLaw law(sand_with(0.62, 1000.0));
    Particle particle(law, at_rest(5e3, 0.45));
    for (int k = 0; k < 3000; ++k) {
      const double eps_q = particle.eps_q();
      SymmetricTensor strain = random_strain(generator, size);
      for (int i = 0; i < 3; ++i) strain[i] -= 0.01 * size;
      particle.strain_by(strain);
      ASSERT_LE(particle.q(), particle.qhat() + 1.1e-8 * particle.p_star()) << size << " " << k;
      ASSERT_GE(particle.eps_q(), eps_q);
    }
  }
}

TEST(SandLaw, nearly_isotropic_compression_does_not_leave_the_surface) {
  const SandLaw law(sand_with(0.62, 0.0));
  Particle particle(law, at_rest(200e3, 0.45));
  for (double shear : {0.0, 0.01, 0.03, 0.05, 0.1, 0.2}) {
    particle.strain_by(1e-4 * principal(-1.0 + shear, -1.0 - 2.0 * shear, -1.0 + shear), 10);
    EXPECT_LE(particle.q(), particle.qhat() + 1.1e-8 * particle.p_star()) << shear;
  }
}

TEST(SandLaw, prescribed_stress_at_rest_starts_on_the_surface) {
  for (double K0 : {0.4, 0.5, 0.8, 1.3}) {
    const SandLaw law(sand_with(0.524, 1000.0));
    Particle particle(law, at_rest(2.1e3, K0));
    EXPECT_NEAR(particle.q(), particle.qhat(), 1e-10 * particle.p_star());
    EXPECT_GT(law.surface()
                  .slopes(particle.surface_state(), law.surface().at(particle.surface_state()))
                  .F,
              0.0);
    const double eps_q = particle.eps_q();
    const SymmetricTensor direction = (1e-7 / particle.q()) * deviator(particle.stress);
    particle.strain_by(-1.0 * direction);
    EXPECT_EQ(particle.eps_q(), eps_q);
    particle.strain_by(3.0 * direction);
    EXPECT_GT(particle.eps_q(), eps_q);
  }
}

TEST(SandLaw, refuses_a_stress_ratio_that_the_sand_cannot_carry) {
  const SandLaw law(sand_with(0.657, 0.0));
  try {
    Particle particle(law, at_rest(10e3, 0.1));
    FAIL() << "accepted";
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("q/p = 2.25"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("at most q/p = 1."), std::string::npos)
        << error.what();
  }
}

/// Sheared on the surface, then unloaded to the pressure p and no deviator.
Particle unloaded(const SandLaw& law) {
  Particle particle(law, isotropic(60e3));
  particle.strain_by(principal(1e-3, -3e-3, 1e-3), 100);
  const double G = law.surface().elasticity().shear_modulus(particle.p_star());
  SymmetricTensor back = deviator(particle.stress);
  particle.strain_by((-0.5 / G) * back, 50);
  return particle;
}

TEST(SandLaw, closed_elastic_loop_does_the_hypoelastic_work) {
  const SandLaw law(sand_with(0.6, 0.0));
  const SandElasticity& elasticity = law.surface().elasticity();
  Particle particle = unloaded(law);
  ASSERT_NEAR(particle.q() / particle.p_star(), 0.0, 1e-9);
  const SymmetricTensor start = particle.stress;
  const std::array<double, 3> start_state = particle.state;

  const double p1 = particle.p_star(), p2 = 0.6 * p1, q = 0.3 * p1;
  const double G1 = elasticity.shear_modulus(p1), G2 = elasticity.shear_modulus(p2);
  const double swelling = -elasticity.strain_to_pressure(p1, p2);
  const SymmetricTensor axial = principal(0.5, -1.0, 0.5);
  double work = 0.0;
  const auto follow = [&](const SymmetricTensor& strain) {
    for (int k = 0; k < 500; ++k) {
      const SymmetricTensor before = particle.stress;
      particle.strain_by(0.002 * strain);
      work += 0.001 * contract(before + particle.stress, strain);
    }
  };
  follow(q / (3.0 * G1) * axial);
  EXPECT_NEAR(particle.q(), q, 1e-9 * q);
  follow(swelling / 3.0 * principal(1.0, 1.0, 1.0));
  EXPECT_NEAR(particle.p_star(), p2, 1e-9 * p2);
  EXPECT_NEAR(particle.q(), q, 1e-9 * q);
  follow(-q / (3.0 * G2) * axial);
  follow(-swelling / 3.0 * principal(1.0, 1.0, 1.0));

  EXPECT_NEAR(work, q * q / 6.0 * (1.0 / G1 - 1.0 / G2), 1e-3 * std::abs(work));
  EXPECT_LT(norm(particle.stress + (-1.0) * start), 1e-9 * p1);
  EXPECT_EQ(particle.eps_q(), start_state[SandLaw::eps_q]);
  EXPECT_NEAR(particle.void_ratio(), start_state[SandLaw::void_ratio], 1e-12);
}

void cycle(Particle& particle, const SymmetricTensor& strain, int times) {
  for (int k = 0; k < times; ++k) {
    particle.strain_by(strain);
    particle.strain_by(-1.0 * strain);
  }
}

class SmallCycles : public ::testing::TestWithParam<SymmetricTensor> {};

TEST_P(SmallCycles, do_not_ratchet) {
  const SandLaw law(sand_with(0.524, 1000.0));
  Particle particle(law, at_rest(4e3, 0.5));
  particle.strain_by(principal(1e-3, -2e-3, 0.0), 100);
  cycle(particle, GetParam(), 1);  // a path that yields in unloading settles in the first cycle
  const SymmetricTensor start = particle.stress;
  const double eps_q = particle.eps_q();
  cycle(particle, GetParam(), 10000);
  EXPECT_LT(norm(particle.stress + (-1.0) * start), 1e-6 * particle.p_star());
  EXPECT_NEAR(particle.eps_q(), eps_q, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(SandLaw, SmallCycles,
                         ::testing::Values(2e-6 * principal(-0.4, 1.0, 0.0),
                                           SymmetricTensor{{-3e-6, 3e-6, 0, 1e-6, 0, 2e-6}},
                                           1e-6 * principal(-1.0, -1.0, -1.0),
                                           1e-6 * principal(1.0 - 0.01, 1.0 + 0.03, 1.0 - 0.02)));

TEST(SandLaw, does_not_ratchet_where_the_loading_index_is_positive_inside_the_surface) {
  const SandLaw law(sand_with(0.524, 1000.0));
  Particle particle(law, at_rest(4e3, 0.5));
  const SymmetricTensor start = particle.stress;
  const double eps_q = particle.eps_q();
  const SurfaceState y = particle.surface_state();
  const SurfacePoint point = law.surface().at(y);
  const auto [C, E, F, T] = law.surface().slopes(y, point);
  const double K = law.surface().elasticity().bulk_modulus(y.p_star);
  // Swelling by dv lowers the surface by C K dv, unloading by dq lowers q by 10 % more.
  const double dv = 1e-6, dq = 1.1 * (C * K - E * (1.0 + y.void_ratio)) * dv / (3.0 * point.G);
  ASSERT_LT((3.0 * point.G - F) * dq, 3.0 * point.G * dq / 1.1);
  cycle(particle, SymmetricTensor{{dv / 3 - dq / 2, dv / 3 + dq, dv / 3 - dq / 2, 0, 0, 0}}, 10000);
  EXPECT_LT(norm(particle.stress + (-1.0) * start), 1e-6 * particle.p_star());
  EXPECT_NEAR(particle.eps_q(), eps_q, 1e-9);
}

TEST(SandLaw, reversal_returns_to_the_surface_it_left) {
  const SandLaw law(sand_with(0.6, 0.0));
  Particle straight(law, isotropic(80e3)), detour(law, isotropic(80e3));
  const SymmetricTensor axial = 1e-2 * principal(0.4, -1.0, 0.4);
  straight.strain_by(axial, 50);
  detour.strain_by(axial, 50);
  detour.strain_by(-0.01 * axial);
  EXPECT_LT(detour.q(), 0.99 * detour.qhat());
  detour.strain_by(0.01 * axial + 0.1 * axial);
  straight.strain_by(0.1 * axial);
  EXPECT_LT(norm(straight.stress + (-1.0) * detour.stress), 1e-4 * straight.p_star());
  EXPECT_NEAR(straight.eps_q(), detour.eps_q(), 1e-7);
}

class Splitting : public ::testing::TestWithParam<SymmetricTensor> {};

TEST_P(Splitting, does_not_change_the_result) {
  const SandLaw law(sand_with(0.6, 1000.0));
  std::vector<Particle> particles;
  for (int parts : {1, 7, 100, 10000}) {
    Particle particle(law, at_rest(20e3, 0.5));
    particle.strain_by(GetParam(), parts);
    particle.strain_by(-0.05 * GetParam(), parts);
    particle.strain_by(SymmetricTensor{{0.004, -0.006, 0, 0.003, 0, 0.001}}, parts);
    particles.push_back(particle);
  }
  for (const Particle& particle : particles) {
    EXPECT_LT(norm(particle.stress + (-1.0) * particles.back().stress),
              2e-3 * particles.back().p_star());
    EXPECT_NEAR(particle.eps_q(), particles.back().eps_q(), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(SandLaw, Splitting,
                         ::testing::Values(principal(0.01, -0.02, 0.0),
                                           SymmetricTensor{{0.002, -0.004, 0, 0.02, 0, 0}},
                                           principal(-0.02, -0.02, -0.02),
                                           principal(-0.002, 0.01, -0.003)));

TEST(SandLaw, cohesion_only_shifts_the_mean_stress) {
  const SandLaw with(sand_with(0.6, 1000.0)), without(sand_with(0.6, 0.0));
  Particle cohesive(with, isotropic(4e3)), frictional(without, isotropic(5e3));
  const SymmetricTensor strain{{0.003, -0.01, 0.001, 0.004, 0, 0}};
  cohesive.strain_by(strain, 40);
  frictional.strain_by(strain, 40);
  EXPECT_LT(norm(cohesive.stress + (-1.0) * (frictional.stress + isotropic(-1000.0))), 1e-6);

  SandParameters sand = sand_with(0.6, 1000.0);
  sand.cohesion_shift = CohesionShift::cot_phi;
  EXPECT_NEAR(SandLaw(sand).invariants(isotropic(0.0)).p_star, 1670.0, 5.0);
}

// Low stress -------------------------------------------------------------------------------------

struct LowStressSand {
  const char* name;
  double cohesion;
  std::optional<double> gap_opening;
};

class LowStress : public ::testing::TestWithParam<LowStressSand> {
 protected:
  static SandLaw law() {
    SandParameters sand = sand_with(0.657, GetParam().cohesion);
    sand.gap_opening = GetParam().gap_opening;
    return SandLaw(sand);
  }
};

TEST_P(LowStress, has_no_nan_through_tension_and_back) {
  const SandLaw law = LowStress::law();
  Particle particle(law, at_rest(3e3, 0.5));
  std::mt19937 generator(11);
  for (int k = 0; k < 20000; ++k) {
    SymmetricTensor strain = random_strain(generator, k % 3 == 0 ? 1e-3 : 1e-5);
    const double swell = 3e-4 * std::cos(2e-3 * k);
    for (int i = 0; i < 3; ++i) strain[i] += swell;
    particle.strain_by(strain);
    ASSERT_TRUE(std::isfinite(norm(particle.stress))) << "step " << k;
    ASSERT_TRUE(std::isfinite(particle.void_ratio() + particle.eps_q() + particle.gap()));
    ASSERT_GE(particle.p_star(), 10.0 * (1.0 - 1e-9));
    ASSERT_GE(particle.gap(), 1.0);
    ASSERT_LE(particle.q(), particle.qhat() + 1.1e-8 * particle.p_star()) << "step " << k;
  }
}

TEST_P(LowStress, reclosing_gap_carries_its_tension_alone_before_it_is_closed) {
  const SandLaw law = LowStress::law();
  Particle particle(law, at_rest(3e3, 0.5));
  double volumetric = 0.0;
  const auto strain_by = [&](const SymmetricTensor& strain) {
    particle.strain_by(strain);
    volumetric += trace(strain);
    EXPECT_NEAR(std::log((1 + particle.void_ratio()) / 1.657 * particle.gap()), volumetric, 1e-12);
  };
  for (int k = 0; k < 300; ++k) strain_by(1e-3 * principal(0.2, 1.0, -0.1));
  ASSERT_GT(particle.gap(), 1.1);
  EXPECT_EQ(law.count_at_limits(particle.batch()), 1U);

  while (std::log(particle.gap()) > 1.2e-3) {
    strain_by(1e-3 * principal(-0.4, -0.9, 0.1));
    ASSERT_NEAR(particle.p_star(), law.gap().p_star(particle.gap()), 1e-9);
    ASSERT_LT(particle.q(), 1e-9);
  }
  strain_by(1e-3 * principal(-0.4, -0.9, 0.1));
  strain_by(1e-2 * principal(-0.4, -0.9, -0.2));
  EXPECT_EQ(particle.gap(), 1.0);
  EXPECT_GT(particle.p_star(), 20.0);
}

INSTANTIATE_TEST_SUITE_P(SandLaw, LowStress,
                         ::testing::Values(LowStressSand{"frictional", 0.0, {}},
                                           LowStressSand{"cohesive", 1000.0, {}},
                                           LowStressSand{"fading", 1000.0, 2e-3}),
                         [](const auto& instance) { return instance.param.name; });

TEST(SandLaw, passes_nan_on) {
  const SandLaw law(sand_with(0.6, 1000.0));
  Particle particle(law, at_rest(3e3, 0.5));
  particle.strain_by(principal(std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0));
  EXPECT_TRUE(std::isnan(particle.stress[1]));
  particle.strain_by(principal(1e-5, 0.0, 0.0));
  EXPECT_TRUE(std::isnan(particle.stress[1]));
}

// Vibration at constant volume --------------------------------------------------------------------

class Vibration : public ::testing::TestWithParam<double> {};  // K0; 1 starts at eps_q = 0

/// Isochoric strains that jump about the start, none of which adds up.
double pressure_after_vibration(const SandLaw& law, double p, double K0, double size) {
  Particle particle(law, at_rest(3.0 * p / (1.0 + 2.0 * K0), K0));
  std::mt19937 generator(5);
  SymmetricTensor before;
  for (int k = 0; k < 20000; ++k) {
    const SymmetricTensor strain = deviator(random_strain(generator, size));
    particle.strain_by(strain + (-1.0) * before);
    before = strain;
  }
  return -trace(particle.stress) / 3.0;
}

TEST_P(Vibration, of_a_small_size_takes_next_to_no_pressure) {
  const double p = 90e3;
  for (double e : {0.524, 0.63, 0.8})
    for (double kappa : {0.012, 0.002}) {  // the stiffer sand reacts more to plastic volume
      SandParameters sand = sand_with(e, 0.0);
      sand.kappa = kappa;
      const double share = pressure_after_vibration(SandLaw(sand), p, GetParam(), 4e-6) / p;
      EXPECT_NEAR(share, 1.0, 4e-3) << e << " " << kappa;
    }
}

TEST_P(Vibration, in_cycles_takes_its_toll_in_the_first_alone) {
  const SandLaw law(sand_with(0.8, 0.0));
  Particle particle(law, at_rest(120e3, GetParam()));
  const SymmetricTensor shear{{0, 0, 0, 4e-5, 0, 0}};
  cycle(particle, shear, 1);
  cycle(particle, -1.0 * shear, 1);
  const SymmetricTensor settled = particle.stress;
  cycle(particle, shear, 200);
  cycle(particle, -1.0 * shear, 200);
  EXPECT_LT(norm(particle.stress + (-1.0) * settled), 1e-5 * particle.p_star());
}

/// Loose sand contracts down to it and no further, whatever the path at constant volume.
TEST_P(Vibration, however_long_ends_at_the_critical_pressure) {
  const SandParameters sand = sand_with(0.8, 0.0);
  const SandLaw law(sand);
  const double critical = 1e3 * std::exp((sand.e_Gamma - sand.void_ratio) / sand.lambda_c);
  Particle particle(law, at_rest(120e3, GetParam()));
  const SymmetricTensor shear{{0, 0, 0, 8e-4, 0, 0}};
  double lowest = particle.p_star();
  for (int k = 0; k < 300; ++k) {
    for (double sign : {1.0, -2.0, 1.0}) particle.strain_by(sign * shear, 8);
    lowest = std::min(lowest, particle.p_star());
  }
  EXPECT_NEAR(particle.p_star() / critical, 1.0, 0.05);
  EXPECT_GT(lowest, 0.95 * critical);
}

INSTANTIATE_TEST_SUITE_P(SandLaw, Vibration, ::testing::Values(1.0, 0.5));

// Gaps --------------------------------------------------------------------------------------------

constexpr double fading = 0.013;    // J_gap - 1 at which the tension is gone
constexpr double remnant = 1660.0;  // Pa, p_c less the floor

SandParameters fading_sand(double cohesion = 1670.0) {
  SandParameters sand = sand_with(0.657, cohesion);
  sand.gap_opening = fading;
  return sand;
}

/// Torn in all directions until the gap is open by the share.
Particle torn(const SandLaw& law, double opening) {
  Particle particle(law, at_rest(3e3, 0.5));
  while (particle.gap() <= 1.0) particle.strain_by(1e-4 * principal(0.5, 1.0, 0.3));
  const double missing = std::log((1.0 + opening) / particle.gap());
  particle.strain_by(missing / 3.0 * principal(1.0, 1.0, 1.0));
  return particle;
}

TEST(SandGap, tension_of_an_open_gap_fades_with_the_opening) {
  const SandLaw law(fading_sand());
  for (double share : {0.02, 0.31, 0.5, 0.94}) {
    const Particle particle = torn(law, share * fading);
    EXPECT_NEAR(particle.gap(), 1.0 + share * fading, 1e-13);
    EXPECT_NEAR(particle.stress[0], (1.0 - share) * remnant, 1e-8);
    EXPECT_EQ(particle.q(), 0.0);
  }
}

TEST(SandGap, wide_open_carries_exactly_no_stress) {
  SandParameters sand = fading_sand();
  for (CohesionShift shift : {CohesionShift::plain, CohesionShift::cot_phi}) {
    sand.cohesion_shift = shift;
    const SandLaw law(sand);
    for (double opening : {1.0001 * fading, 0.4}) {
      Particle particle = torn(law, opening);
      for (int k = 0; k < 6; ++k) EXPECT_EQ(particle.stress[k], 0.0);
      particle.strain_by(1e-3 * SymmetricTensor{{0.4, -0.3, -0.1, 0.8, -0.5, 0.2}});
      for (int k = 0; k < 6; ++k) EXPECT_EQ(particle.stress[k], 0.0);
    }
  }
}

TEST(SandGap, tension_comes_back_on_closing_on_the_same_line) {
  const SandLaw law(fading_sand());
  Particle particle = torn(law, 3.0 * fading);
  const std::array<double, 3> state = particle.state;
  while (particle.gap() > 1.0 + 0.05 * fading) {
    particle.strain_by(2e-4 * principal(-0.7, -1.0, 0.2));
    const double share = std::min(1.0, (particle.gap() - 1.0) / fading);
    ASSERT_NEAR(particle.stress[1], (1.0 - share) * remnant, 1e-8);
  }
  EXPECT_EQ(particle.void_ratio(), state[SandLaw::void_ratio]);
  EXPECT_EQ(particle.eps_q(), state[SandLaw::eps_q]);
}

TEST(SandGap, pressure_is_continuous_where_it_opens_and_closes) {
  const SandLaw law(fading_sand());
  const double slope = remnant / fading;  // Pa per volume strain
  for (double beyond : {-1e-8, 1e-8}) {
    Particle particle = torn(law, 0.2 * fading);
    const double volumetric = std::log(particle.gap()) + beyond;
    particle.strain_by(-volumetric / 3.0 * principal(1.0, 1.0, 1.0));
    EXPECT_EQ(particle.gap() > 1.0, beyond < 0.0);
    EXPECT_NEAR(particle.p_star(), 10.0, 2.0 * slope * std::abs(beyond));
  }
}

TEST(SandGap, what_closing_leaves_of_an_increment_strains_the_sand_from_the_floor) {
  const SandLaw law(fading_sand());
  Particle at_once = torn(law, 0.6 * fading), in_two = torn(law, 0.6 * fading);
  const double closing = std::log(at_once.gap()), further = 0.02;
  const SymmetricTensor direction = principal(0.2, 0.5, 0.3);
  at_once.strain_by(-(closing + further) * direction);
  in_two.strain_by(-closing * (1.0 + 1e-12) * direction);
  EXPECT_EQ(in_two.gap(), 1.0);
  in_two.strain_by(-further * direction);
  EXPECT_EQ(at_once.gap(), 1.0);
  EXPECT_GT(at_once.p_star(), 40.0);
  EXPECT_LT(norm(at_once.stress + (-1.0) * in_two.stress), 1e-5 * at_once.p_star());
}

TEST(SandGap, opened_and_closed_does_no_work) {
  const SandLaw law(fading_sand());
  Particle particle = torn(law, 0.1 * fading);
  const SymmetricTensor start = particle.stress;
  double work = 0.0, opening_work = 0.0;
  const int parts = 4000;
  for (int k = 0; k < 2 * parts; ++k) {
    const double size = (k < parts ? 1.7 : -1.7) * fading / parts;
    const SymmetricTensor strain = size * SymmetricTensor{{0.6, 0.3, 0.1, 0.9, 0, 0.2}};
    const SymmetricTensor before = particle.stress;
    particle.strain_by(strain);
    work += 0.5 * contract(before + particle.stress, strain);
    if (k + 1 == parts) opening_work = work;
  }
  // A triangle of 90 % of the remnant by 90 % of the opening, but for J_gap - 1 being no ln.
  EXPECT_NEAR(opening_work, 0.5 * 0.81 * remnant * fading, 0.01 * opening_work);
  EXPECT_NEAR(work, 0.0, 1e-9 * opening_work);
  EXPECT_LT(norm(particle.stress + (-1.0) * start), 1e-7);
}

TEST(SandGap, is_counted_at_the_limits_however_far_it_is_open) {
  const SandLaw law(fading_sand());
  for (double share : {0.01, 0.5, 1.0, 20.0}) {
    Particle particle = torn(law, share * fading);
    EXPECT_EQ(law.count_at_limits(particle.batch()), 1U) << share;
  }
}

/// The same strains to the law with and without the option; expects the same bits.
void expect_option_without_effect(const SandParameters& sand) {
  SandParameters without = sand;
  without.gap_opening.reset();
  const SandLaw law(sand), plain(without);
  Particle particle(law, at_rest(3e3, 0.5)), expected(plain, at_rest(3e3, 0.5));
  for (int k = 0; k < 3000; ++k) {
    const double swell = 3e-4 * std::cos(5e-3 * k);
    const SymmetricTensor strain{{swell, 0.7 * swell, 0.1 * swell, 1e-5, 0, 2e-5 * (k % 7 - 3)}};
    particle.strain_by(strain);
    expected.strain_by(strain);
    for (int i = 0; i < 6; ++i) ASSERT_EQ(particle.stress[i], expected.stress[i]) << k;
    ASSERT_EQ(particle.state, expected.state);
  }
}

TEST(SandGap, has_no_tension_to_lose_without_cohesion) {
  for (double cohesion : {0.0, 7.0}) expect_option_without_effect(fading_sand(cohesion));
}

TEST(SandGap, keeps_the_tension_of_the_floor_where_no_opening_is_given) {
  SandParameters sand = fading_sand();
  sand.gap_opening.reset();
  const SandLaw law(sand);
  for (double opening : {0.3 * fading, fading, 0.2}) {
    const Particle particle = torn(law, opening);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(particle.stress[k], remnant);
    EXPECT_EQ(law.gap().p_star(1.0 + opening), sand.pressure_floor);
  }
}

// Scalars ----------------------------------------------------------------------------------------

TEST(SandLaw, bulk_modulus_is_that_of_its_reading) {
  SandConstants sand;
  const double e0 = 0.6, p = 30e3;
  const auto K = [&](BulkModulus reading) {
    sand.bulk = reading;
    return SandElasticity(sand, e0).bulk_modulus(p);
  };
  sand.bulk_xi = 0.7;
  sand.poisson_ratio = 0.15;
  const double G = SandElasticity(sand, e0).shear_modulus(p);
  const double log = 1.6 * p / 0.012, power = log / 0.7 * std::pow(101e3 / p, 0.7);
  EXPECT_NEAR(K(BulkModulus::log), log, 1e-12 * log);
  EXPECT_NEAR(K(BulkModulus::power), power, 1e-9 * power);
  EXPECT_NEAR(K(BulkModulus::poisson), 2.3 * G / 2.1, 1e-9 * G);
}

/// p* and the mean of G at the end of an elastic path, by the midpoint rule.
SandElasticity::PathEnd followed_in_small_steps(const SandElasticity& elasticity, double p,
                                                double strain) {
  constexpr int steps = 20000;
  double shear = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double middle = p + 0.5 * elasticity.bulk_modulus(p) * strain / steps;
    shear += elasticity.shear_modulus(middle) / steps;
    p += elasticity.bulk_modulus(middle) * strain / steps;
  }
  return {p, shear};
}

TEST(SandLaw, elastic_paths_follow_every_reading_of_the_bulk_modulus) {
  for (const SandReading& reading : sand_readings) {
    SandConstants sand;
    reading.choose(sand);
    const SandElasticity elasticity(sand, 0.6);
    const double p = 30e3;
    for (double strain : {1e-6, -5e-4, 0.005}) {
      const auto end = elasticity.follow(p, strain);
      const auto [pressure, shear] = followed_in_small_steps(elasticity, p, strain);
      EXPECT_NEAR(end.p_star, pressure, 1e-7 * pressure) << reading.name;
      EXPECT_NEAR(end.mean_shear_modulus, shear, 1e-7 * shear) << reading.name;
      EXPECT_NEAR(elasticity.strain_to_pressure(p, end.p_star), strain, 1e-9) << reading.name;
    }
  }
}

TEST(SandLaw, density_and_wave_speed_follow_from_the_constants) {
  const SandLaw law(sand_with(0.6, 1000.0));
  EXPECT_NEAR(law.initial_density(), 2650.0 / 1.6, 1e-9);
  Particle particle(law, isotropic(24e3));
  double modulus = 0.0;
  law.wave_modulus(particle.batch(), {&modulus, 1});
  const double G = 250.0 * std::pow(2.973 - 0.6, 2) / 1.6 * std::sqrt(25e3 * 101e3);
  EXPECT_NEAR(modulus, 1.6 * 25e3 / 0.012 + 4.0 / 3.0 * G, 1e-6 * G);
}

TEST(SandLaw, loose_particles_are_counted_at_the_cap) {
  const SandLaw loose(sand_with(1.1, 0.0)), dense(sand_with(0.524, 0.0));
  EXPECT_EQ(loose.count_at_limits(Particle(loose, isotropic(50e3)).batch()), 1U);
  EXPECT_EQ(dense.count_at_limits(Particle(dense, isotropic(50e3)).batch()), 0U);
}

TEST(SandLaw, refuses_constants_that_leave_no_solution_for_q) {
  SandParameters sand;
  sand.d0 = 0.95;
  EXPECT_THROW(SandLaw{sand}, BadInput);
  sand.dilatancy = Dilatancy::lode;
  EXPECT_NO_THROW(SandLaw{sand});
  sand.d0 = 1.25;
  EXPECT_THROW(SandLaw{sand}, BadInput);
  sand.softening = Softening::plain;
  EXPECT_NO_THROW(SandLaw{sand});
  sand.e_min = 0.8;
  EXPECT_THROW(SandLaw{sand}, BadInput);
}

}  // namespace
}  // namespace mpm::material
