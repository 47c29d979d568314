#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "mpm/cases/VortexMotion.hpp"
#include "mpm/material/NeoHookean.hpp"

namespace mpm::cases {
namespace {

using Matrix = std::array<Vector<2>, 2>;

constexpr double E = 1300.0, nu = 0.27, density = 870.0;
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
constexpr VortexMotion motion{
    .amplitude = 0.7, .half_period = 1.4, .shear_speed_squared = mu / density};

constexpr double small = 1e-4;  // m or s, of central differences

Vector<2> moved(Vector<2> X, std::size_t direction, double by) {
  X[direction] += by;
  return X;
}

Matrix deformation_gradient(const Vector<2>& X, double t) {
  Matrix F;
  for (std::size_t j = 0; j < 2; ++j) {
    const Vector<2> ahead = motion.position(moved(X, j, small), t);
    const Vector<2> behind = motion.position(moved(X, j, -small), t);
    for (std::size_t i = 0; i < 2; ++i) F[i][j] = (ahead[i] - behind[i]) / (2 * small);
  }
  return F;
}

/// P = mu F + (lambda ln J - mu) F^-T of the law sigma = [mu (b - 1) + lambda ln J 1]/J.
Matrix first_piola_stress(const Vector<2>& X, double t) {
  const Matrix F = deformation_gradient(X, t);
  const double J = F[0][0] * F[1][1] - F[0][1] * F[1][0];
  const double factor = (lambda * std::log(J) - mu) / J;
  return {{{mu * F[0][0] + factor * F[1][1], mu * F[0][1] - factor * F[1][0]},
           {mu * F[1][0] - factor * F[0][1], mu * F[1][1] + factor * F[0][0]}}};
}

/// div P, N/m^3.
Vector<2> divergence(const Vector<2>& X, double t) {
  Vector<2> sum{};
  for (std::size_t j = 0; j < 2; ++j) {
    const Matrix ahead = first_piola_stress(moved(X, j, small), t);
    const Matrix behind = first_piola_stress(moved(X, j, -small), t);
    for (std::size_t i = 0; i < 2; ++i) sum[i] += (ahead[i][j] - behind[i][j]) / (2 * small);
  }
  return sum;
}

const std::array<Vector<2>, 4> points{{{0.9, 0.1}, {-0.3, 0.8}, {0.6, -1.0}, {-0.7, -0.72}}};
const std::array<double, 3> times{0.2, 0.9, 1.7};

TEST(VortexMotion, body_force_balances_inertia_and_neo_hookean_stress) {
  for (const Vector<2>& X : points)
    for (const double t : times) {
      const Vector<2> force = motion.body_force(X, t), stress = divergence(X, t);
      const Vector<2> ahead = motion.position(X, t + small), now = motion.position(X, t),
                      behind = motion.position(X, t - small);
      for (std::size_t i = 0; i < 2; ++i) {
        const double acceleration = (ahead[i] - 2 * now[i] + behind[i]) / (small * small);
        EXPECT_NEAR(force[i], acceleration - stress[i] / density, 1e-4);
      }
      EXPECT_GT(std::hypot(force[0], force[1]), 0.1);  // something was balanced
    }
}

TEST(VortexMotion, velocity_is_the_rate_of_position) {
  for (const Vector<2>& X : points)
    for (const double t : times) {
      const Vector<2> velocity = motion.velocity(X, t), ahead = motion.position(X, t + small),
                      behind = motion.position(X, t - small);
      for (std::size_t i = 0; i < 2; ++i)
        EXPECT_NEAR(velocity[i], (ahead[i] - behind[i]) / (2 * small), 1e-7);
    }
}

TEST(VortexMotion, edges_stay_and_carry_no_traction) {
  for (const double R : {VortexMotion::inner_radius, VortexMotion::outer_radius}) {
    const Vector<2> N{0.8, 0.6}, X{R * N[0], R * N[1]};
    const Vector<2> u = motion.displacement(X, 0.7);
    const Matrix P = first_piola_stress(X, 0.7);
    EXPECT_NEAR(std::hypot(u[0], u[1]), 0.0, 1e-14);
    for (std::size_t i = 0; i < 2; ++i)
      EXPECT_NEAR(P[i][0] * N[0] + P[i][1] * N[1], 0.0, 1e-4 * mu);
  }
}

TEST(NeoHookean, has_the_stress_of_the_left_cauchy_green_tensor_at_constant_volume) {
  constexpr double stretch = 0.31;  // logarithmic
  const material::NeoHookean law({.youngs_modulus = E, .poisson_ratio = nu, .density = density});
  double increment_xx = stretch, increment_yy = -stretch, volume_ratio = 1.0;
  std::array<double, 3> stress{};
  material::Batch batch;
  batch.size = 1;
  batch.strain_increment.component[0] = &increment_xx;
  batch.strain_increment.component[1] = &increment_yy;
  for (std::size_t k = 0; k < 3; ++k) batch.stress.component[k] = &stress[k];
  batch.state = {&volume_ratio};
  law.update_stress(batch);
  EXPECT_NEAR(stress[0], mu * (std::exp(2 * stretch) - 1.0), 1e-10 * mu);
  EXPECT_NEAR(stress[1], mu * (std::exp(-2 * stretch) - 1.0), 1e-10 * mu);
  EXPECT_NEAR(stress[2], 0.0, 1e-10 * mu);
}

TEST(NeoHookean, has_the_strain_energy_of_its_stretches) {
  constexpr std::array<double, 3> stretch{0.31, -0.12, 0.07};  // logarithmic
  const material::NeoHookean law({.youngs_modulus = E, .poisson_ratio = nu, .density = density});
  std::array<double, 3> increment = stretch, stress{};
  double volume_ratio = 1.0, density_of_energy = 0.0;
  material::Batch batch;
  batch.size = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    batch.strain_increment.component[k] = &increment[k];
    batch.stress.component[k] = &stress[k];
  }
  batch.state = {&volume_ratio};
  law.update_stress(batch);
  ASSERT_TRUE(law.has_strain_energy());
  law.strain_energy_density(batch, {&density_of_energy, 1});
  const double log_J = 0.31 - 0.12 + 0.07;
  double trace = 0.0;
  for (const double e : stretch) trace += std::exp(2 * e);
  const double energy = 0.5 * mu * (trace - 3.0) - mu * log_J + 0.5 * lambda * log_J * log_J;
  EXPECT_NEAR(density_of_energy * std::exp(log_J), energy, 1e-12 * mu);
}

}  // namespace
}  // namespace mpm::cases
