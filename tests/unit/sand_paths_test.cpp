// Paths that nobody has tuned the sand law to, under all readings of its equations.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "mpm/material/SandLaw.hpp"
#include "support/SandParticle.hpp"
#include "support/SandReadings.hpp"

namespace mpm::material {
namespace {

/// A reading, and a cohesion in Pa.
class AnyPath : public ::testing::TestWithParam<std::tuple<std::size_t, double>> {
 protected:
  static SandLaw sand(double void_ratio) {
    const auto [reading, cohesion] = GetParam();
    SandParameters parameters = sand_with(void_ratio, cohesion);
    sand_readings.at(reading).choose(parameters);
    return SandLaw(parameters);
  }
};

std::string name_of(const ::testing::TestParamInfo<std::tuple<std::size_t, double>>& instance) {
  const auto [reading, cohesion] = instance.param;
  return name_of_reading(reading) + (cohesion > 0.0 ? "_cohesive" : "");
}

INSTANTIATE_TEST_SUITE_P(SandLaw, AnyPath,
                         ::testing::Combine(::testing::Range<std::size_t>(0, sand_readings.size()),
                                            ::testing::Values(0.0, 1300.0)),
                         name_of);

constexpr double on_surface = 1e-6;  // of p*

/// How often a path was seen on the surface, and inside it.
struct Seen {
  int loading = 0, inside = 0, at_floor = 0;
};

/// Whether a little more of the strain would load; within one increment loading may end.
bool loads(Particle particle, const SymmetricTensor& strain) {
  const double eps_q = particle.eps_q();
  particle.strain_by(1e-8 * strain);
  return particle.eps_q() > eps_q;
}

void strain_and_check(Particle& particle, const SymmetricTensor& strain, Seen& seen) {
  const double eps_q_before = particle.eps_q();
  particle.strain_by(strain);
  ASSERT_TRUE(std::isfinite(norm(particle.stress) + particle.void_ratio() + particle.gap()));
  ASSERT_GE(particle.p_star(), 10.0 * (1.0 - 1e-9));
  ASSERT_GE(particle.eps_q(), eps_q_before);
  const double excess = (particle.q() - particle.qhat()) / particle.p_star();
  ASSERT_LE(excess, on_surface);
  if (particle.p_star() < 10.0 * (1.0 + 1e-9)) {
    ++seen.at_floor;
  } else if (loads(particle, strain)) {
    ++seen.loading;
    ASSERT_GE(excess, -on_surface) << "loading, but inside the surface";
  } else {
    ++seen.inside;
  }
}

constexpr double highest_pressure = 20e6;  // Pa, from where on paths swell

/// Straight pieces in random directions, of sizes from 1e-6 to 1e-3 an increment.
void wander(Particle& particle, unsigned seed, int pieces, Seen& seen) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> power(-6.0, -3.0), tilt(-0.15, 0.1);
  for (int piece = 0; piece < pieces; ++piece) {
    const double size = std::pow(10.0, power(generator));
    SymmetricTensor direction = random_strain(generator, size);
    const double mean = trace(direction) / 3.0;
    double swelling = tilt(generator) * size;
    if (particle.p_star() > highest_pressure) swelling = std::abs(swelling);
    for (int k = 0; k < 3; ++k) direction[k] += swelling - mean;
    for (int k = 0; k < 20; ++k) {
      ASSERT_NO_FATAL_FAILURE(strain_and_check(particle, direction, seen))
          << "piece " << piece << ", increment " << k;
    }
  }
}

TEST_P(AnyPath, stays_on_the_surface_while_loading_and_never_leaves_it_outwards) {
  Seen seen;
  unsigned seed = 100;
  for (double void_ratio : {0.5, 0.58, 0.66, 0.8, 0.95})
    for (double pressure : {2e3, 15e3, 130e3, 2e6}) {
      const SandLaw law = sand(void_ratio);
      for (int path = 0; path < 4; ++path) {
        Particle particle(law, isotropic(pressure));
        ASSERT_NO_FATAL_FAILURE(wander(particle, ++seed, 60, seen))
            << "e0 " << void_ratio << ", p " << pressure << ", seed " << seed;
      }
    }
  EXPECT_GT(seen.loading, 20000);
  EXPECT_GT(seen.inside, 8000);
}

/// Sheared on the surface, then drawn back to a fifth of the deviator.
Particle inside(const SandLaw& law, double pressure) {
  Particle particle(law, isotropic(pressure));
  particle.strain_by(principal(2e-3, -5e-3, 1e-3), 100);
  const double G = law.surface().elasticity().shear_modulus(particle.p_star());
  particle.strain_by((-0.8 * 0.5 / G) * deviator(particle.stress), 50);
  return particle;
}

TEST_P(AnyPath, path_inside_the_surface_gives_back_stress_and_work_when_retraced) {
  for (double pressure : {3e3, 90e3, 1.5e6}) {
    const SandLaw law = sand(0.6);
    Particle particle = inside(law, pressure);
    const SymmetricTensor start = particle.stress;
    const double eps_q = particle.eps_q(), void_ratio = particle.void_ratio();
    const double size =
        0.02 * particle.p_star() / law.surface().elasticity().shear_modulus(particle.p_star());
    std::mt19937 generator(23);
    std::vector<SymmetricTensor> path;
    for (int k = 0; k < 12; ++k) path.push_back(random_strain(generator, size));
    double work = 0.0, largest = 0.0;
    const auto follow = [&](const SymmetricTensor& strain) {
      for (int k = 0; k < 20; ++k) {
        const SymmetricTensor before = particle.stress;
        particle.strain_by(0.05 * strain);
        work += 0.025 * contract(before + particle.stress, strain);
        ASSERT_LT(particle.q(), particle.qhat()) << "the path is not inside";
      }
      largest = std::max(largest, std::abs(work));
    };
    for (const SymmetricTensor& strain : path) ASSERT_NO_FATAL_FAILURE(follow(strain));
    for (auto strain = path.rbegin(); strain != path.rend(); ++strain)
      ASSERT_NO_FATAL_FAILURE(follow(-1.0 * *strain));
    EXPECT_LT(norm(particle.stress + (-1.0) * start), 1e-9 * particle.p_star());
    EXPECT_LT(std::abs(work), 1e-9 * largest);
    EXPECT_EQ(particle.eps_q(), eps_q);
    EXPECT_NEAR(particle.void_ratio(), void_ratio, 1e-12);
  }
}

TEST_P(AnyPath, closed_loop_in_p_and_q_does_the_hypoelastic_work) {
  const SandLaw law = sand(0.64);
  const SandElasticity& elasticity = law.surface().elasticity();
  Particle particle = inside(law, 240e3);
  particle.strain_by((-0.5 / elasticity.shear_modulus(particle.p_star())) *
                     deviator(particle.stress));
  const double p1 = particle.p_star(), p2 = 0.7 * p1, q = 0.25 * p1;
  const double G1 = elasticity.shear_modulus(p1), G2 = elasticity.shear_modulus(p2);
  const double swelling = -elasticity.strain_to_pressure(p1, p2);
  const SymmetricTensor shear{{0, 0, 0, 1, 0, 0}};  // q = sqrt(3) tau
  double work = 0.0;
  const auto follow = [&](const SymmetricTensor& strain) {
    for (int k = 0; k < 400; ++k) {
      const SymmetricTensor before = particle.stress;
      particle.strain_by(0.0025 * strain);
      work += 0.00125 * contract(before + particle.stress, strain);
    }
  };
  follow(q / (2.0 * std::sqrt(3.0) * G1) * shear);
  follow(swelling / 3.0 * principal(1, 1, 1));
  follow(-q / (2.0 * std::sqrt(3.0) * G2) * shear);
  follow(-swelling / 3.0 * principal(1, 1, 1));
  EXPECT_LT(work, 0.0);
  EXPECT_NEAR(work, q * q / 6.0 * (1.0 / G1 - 1.0 / G2), 0.01 * std::abs(work));
}

TEST_P(AnyPath, ten_thousand_small_cycles_wear_nothing_down) {
  for (double pressure : {2.5e3, 180e3}) {
    const SandLaw law = sand(0.61);
    Particle particle(law, isotropic(pressure));
    particle.strain_by(principal(2e-3, -4e-3, 1e-3), 100);
    const SymmetricTensor unload{{3e-7, 2e-6, -4e-7, 1e-6, 0, -5e-7}};
    const auto cycle = [&] {
      particle.strain_by(unload);
      particle.strain_by(-1.0 * unload);
    };
    cycle();
    const double q = particle.q(), eps_q = particle.eps_q(), void_ratio = particle.void_ratio();
    for (int k = 0; k < 10000; ++k) cycle();
    EXPECT_NEAR(particle.q(), q, 1e-6 * q);
    EXPECT_NEAR(particle.eps_q(), eps_q, 1e-9);
    EXPECT_NEAR(particle.void_ratio(), void_ratio, 1e-12);
  }
}

TEST_P(AnyPath, undrained_cycles_to_no_pressure_and_loading_after_them_are_sound) {
  for (double void_ratio : {0.6, 0.8, 1.15}) {
    const SandLaw law = sand(void_ratio);
    Particle particle(law, at_rest(6e3, 0.6));
    Seen seen;
    for (int k = 0; k < 8000; ++k) {
      const double rate = 4e-4 * std::cos(0.05 * k);
      const SymmetricTensor strain{{0.3 * rate, -0.3 * rate, 0, rate, 0, 0}};
      ASSERT_NO_FATAL_FAILURE(strain_and_check(particle, strain, seen)) << "step " << k;
    }
    EXPECT_EQ(particle.gap(), 1.0);
    EXPECT_NEAR(particle.void_ratio(), void_ratio, 1e-9);
    if (void_ratio > 1.0) {
      EXPECT_GT(seen.at_floor, 1000) << "loose sand did not liquefy";
    }
  }
}

TEST_P(AnyPath, opens_and_closes_again_and_again_without_stress_in_the_gap) {
  const SandLaw law = sand(0.63);
  Particle particle(law, at_rest(4e3, 0.5));
  Seen seen;
  for (int round = 0; round < 40; ++round) {
    for (int k = 0; particle.gap() < 1.002; ++k) {
      ASSERT_LT(k, 5000) << "no gap opens";
      particle.strain_by(5e-5 * principal(0.5, 1.0, -0.2));
    }
    for (int k = 0; particle.gap() > 1.0; ++k) {
      ASSERT_LT(k, 1000) << "the gap does not close";
      EXPECT_NEAR(particle.p_star(), 10.0, 1e-9);
      EXPECT_LT(particle.q(), 1e-9);
      particle.strain_by(5e-5 * principal(-0.3, -1.0, 0.1));
    }
    EXPECT_GT(particle.p_star(), 10.0) << "round " << round;
    for (int k = 0; k < 100; ++k) {
      const SymmetricTensor strain = 2e-5 * principal(0.2, -1.0, 0.1);
      ASSERT_NO_FATAL_FAILURE(strain_and_check(particle, strain, seen)) << "round " << round;
    }
  }
  EXPECT_GT(seen.loading, 2000);
}

}  // namespace
}  // namespace mpm::material
