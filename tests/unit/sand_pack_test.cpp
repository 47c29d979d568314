// The steps that the sand law takes four particles at a time, against the same ones alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <tuple>
#include <vector>

#include "../../src/material/SandIntegrator.hpp"
#include "../../src/material/SandPack.hpp"
#include "mpm/material/SandLaw.hpp"
#include "support/SandParticle.hpp"
#include "support/SandReadings.hpp"

namespace mpm::material {
namespace {

/// A batch with storage of its own; `components` as in tensor_components.
class Sands {
 public:
  Sands(const SandLaw& law, std::size_t size, std::size_t components = 6)
      : m_law(law), m_stress(components), m_strain(components), m_state(3), m_size(size) {
    for (auto* columns : {&m_stress, &m_strain, &m_state})
      for (auto& column : *columns) column.assign(size + 1, guard);
  }
  Batch batch() {
    Batch all;
    all.size = m_size;
    for (std::size_t k = 0; k < m_stress.size(); ++k) {
      all.stress.component[k] = m_stress[k].data();
      all.strain_increment.component[k] = m_strain[k].data();
    }
    for (auto& column : m_state) all.state.push_back(column.data());
    return all;
  }
  void set(std::size_t p, const Particle& particle, const SymmetricTensor& strain) {
    for (std::size_t k = 0; k < m_stress.size(); ++k) {
      m_stress[k][p] = particle.stress.components[k];
      m_strain[k][p] = strain.components[k];
    }
    for (std::size_t k = 0; k < 3; ++k) m_state[k][p] = particle.state[k];
  }
  void update() { m_law.update_stress(batch()); }

  /// Everything that is kept of a particle.
  std::vector<std::uint64_t> bits(std::size_t p) const {
    std::vector<std::uint64_t> all;
    for (const auto* columns : {&m_stress, &m_state})
      for (const auto& column : *columns) all.push_back(std::bit_cast<std::uint64_t>(column[p]));
    return all;
  }
  bool guards_stand() const {
    for (const auto* columns : {&m_stress, &m_state})
      for (const auto& column : *columns)
        if (column[m_size] != guard) return false;
    return true;
  }
  SymmetricTensor stress(std::size_t p) { return batch().stress.load(p); }
  double state(std::size_t variable, std::size_t p) const { return m_state[variable][p]; }

 private:
  static constexpr double guard = -77.25;
  const SandLaw& m_law;
  std::vector<std::vector<double>> m_stress, m_strain, m_state;
  std::size_t m_size;
};

SandPoint point_of(const SandLaw& law, const Particle& particle) {
  return {law.invariants(particle.stress).p_star, deviator(particle.stress), particle.eps_q(),
          1.0 + particle.void_ratio(), particle.gap()};
}

/// A sand somewhere on a path, and what is to happen to it next.
struct Case {
  Particle particle;
  SymmetricTensor strain;
};

/// On the surface and inside it, going on, turning, in new directions, in tension, at the floor, in
/// a gap, with and without deviator; with increments of 1e-7 to 1e-4.
std::vector<Case> cases(const SandLaw& law, unsigned seed, int paths, bool in_plane = false) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const auto random = [&](double size) {
    SymmetricTensor strain = random_strain(generator, size);
    if (in_plane) strain[4] = strain[5] = 0.0;
    return strain;
  };
  std::vector<Case> all;
  for (int path = 0; path < paths; ++path) {
    Particle particle(law, isotropic(std::pow(10.0, 3.0 + 3.0 * uniform(generator))));
    SymmetricTensor direction = random(1.0);
    const double mean = trace(direction) / 3.0;
    for (int k = 0; k < 3; ++k) direction[k] -= mean + 0.1 * uniform(generator);
    for (int k = 0; k < 25; ++k) {
      const double size = std::pow(10.0, -7.0 + 3.0 * uniform(generator));
      const SymmetricTensor little = random(0.1 * size);
      for (const SymmetricTensor& strain :
           {size * direction + little, -size * direction + little, random(size),
            size * principal(-1.0, -1.0, -1.0), 30.0 * size * principal(1.0, 1.1, 1.0)})
        all.push_back({particle, strain});
      particle.strain_by(1e-5 * direction, 1 + 4 * k);
      if (k % 5 == 4) direction = random(1.0);
    }
  }
  return all;
}

/// A reading, and a cohesion in Pa.
class SandPacks : public ::testing::TestWithParam<std::tuple<std::size_t, double>> {
 protected:
  static SandParameters sand() {
    const auto [reading, cohesion] = GetParam();
    SandParameters sand = sand_with(0.58, cohesion);
    sand_readings.at(reading).choose(sand);
    return sand;
  }
};

std::string name_of(const ::testing::TestParamInfo<std::tuple<std::size_t, double>>& instance) {
  const auto [reading, cohesion] = instance.param;
  return name_of_reading(reading) + (cohesion > 0.0 ? "_cohesive" : "");
}

INSTANTIATE_TEST_SUITE_P(SandLaw, SandPacks,
                         ::testing::Combine(::testing::Range<std::size_t>(0, sand_readings.size()),
                                            ::testing::Values(0.0, 700.0)),
                         name_of);

TEST_P(SandPacks, take_the_steps_of_the_scalar_integrator) {
  const SandParameters parameters = sand();
  const SandLaw law(parameters);
  const SandIntegrator alone(law.surface(), law.gap(), parameters);
  const std::vector<Case> all = cases(law, 3, 30);
  Sands together(law, all.size());
  for (std::size_t p = 0; p < all.size(); ++p) together.set(p, all[p].particle, all[p].strain);
  together.update();
  for (std::size_t p = 0; p < all.size(); ++p) {
    SandPoint y = point_of(law, all[p].particle);
    ASSERT_TRUE(alone.advance(y, {-trace(all[p].strain), deviator(all[p].strain)}));
    const SymmetricTensor stress = together.stress(p);
    const double p_star = law.invariants(stress).p_star;
    ASSERT_NEAR(p_star, y.p_star, 1e-10 * y.p_star) << p;
    ASSERT_LE(norm(deviator(stress) + (-1.0) * y.s), 1e-10 * y.p_star) << p;
    ASSERT_NEAR(together.state(SandLaw::eps_q, p), y.eps_q, 1e-10 * y.eps_q + 1e-18) << p;
    ASSERT_NEAR(together.state(SandLaw::void_ratio, p), y.specific_volume - 1.0, 1e-14) << p;
    ASSERT_EQ(together.state(SandLaw::gap_volume_ratio, p), y.gap) << p;
  }
}

/// Particles come to lie beside others whenever they are sorted or the ranks share them anew.
TEST_P(SandPacks, give_the_same_bits_in_any_lane_and_company) {
  const SandLaw law(sand());
  std::vector<Case> all = cases(law, 17, 4);
  std::vector<std::vector<std::uint64_t>> expected;
  for (const Case& one : all) {
    Sands alone(law, 1);
    alone.set(0, one.particle, one.strain);
    alone.update();
    ASSERT_TRUE(alone.guards_stand());
    expected.push_back(alone.bits(0));
  }
  std::mt19937 generator(5);
  std::vector<std::size_t> order(all.size());
  for (std::size_t p = 0; p < all.size(); ++p) order[p] = p;
  for (std::size_t size : {2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 31U}) {
    std::shuffle(order.begin(), order.end(), generator);
    for (std::size_t first = 0; first + size <= all.size(); first += size) {
      Sands together(law, size);
      for (std::size_t p = 0; p < size; ++p)
        together.set(p, all[order[first + p]].particle, all[order[first + p]].strain);
      together.update();
      ASSERT_TRUE(together.guards_stand()) << "written behind a batch of " << size;
      for (std::size_t p = 0; p < size; ++p)
        ASSERT_EQ(together.bits(p), expected[order[first + p]]) << "batch of " << size;
    }
  }
}

TEST_P(SandPacks, give_in_the_plane_what_they_give_with_all_components) {
  const SandLaw law(sand());
  const std::vector<Case> all = cases(law, 29, 5, true);
  Sands plane(law, all.size(), 4), space(law, all.size(), 6);
  for (std::size_t p = 0; p < all.size(); ++p)
    for (Sands* sands : {&plane, &space}) sands->set(p, all[p].particle, all[p].strain);
  plane.update();
  space.update();
  for (std::size_t p = 0; p < all.size(); ++p) {
    const double size = law.invariants(space.stress(p)).p_star;
    ASSERT_LE(norm(plane.stress(p) + (-1.0) * space.stress(p)), 1e-12 * size) << p;
    ASSERT_NEAR(plane.state(SandLaw::eps_q, p), space.state(SandLaw::eps_q, p), 1e-14) << p;
  }
}

TEST_P(SandPacks, stay_on_the_surface_through_thousands_of_steps) {
  const SandLaw law(sand());
  for (double size : {1e-6, 1e-5}) {
    Particle particle(law, at_rest(8e3, 0.6));
    for (int k = 0; k < 10'000; ++k) {
      const double turn = 300.0 * size * k;
      particle.strain_by(size * SymmetricTensor{{0.4 + 0.3 * std::sin(turn), -1.0, 0.2,
                                                 0.5 * std::sin(0.7 * turn), 0.1, -0.2}});
      ASSERT_NEAR(particle.q(), particle.qhat(), 1e-10 * particle.p_star()) << "step " << k;
    }
  }
}

TEST_P(SandPacks, take_nearly_all_steps_of_an_explicit_run) {
  const SandParameters parameters = sand();
  const SandLaw law(parameters);
  const SandPackIntegrator integrator(law.surface(), parameters);
  int done = 0, steps = 0;
  for (double pressure : {3e3, 50e3, 500e3}) {
    Particle particle(law, at_rest(pressure, 0.5));
    for (int k = 0; k < 20'000; ++k) {
      const double rate = 3e-6 * (1.0 + std::sin(1e-3 * k) * 2.0);  // back for a third of the time
      const SymmetricTensor strain = rate * SymmetricTensor{{0.5, -1.0, 0.0, 0.6, 0.0, 0.0}};
      std::array<SandPack, 1> y;
      std::array<SandPackEnd, 1> end;
      PackTensor s, e;
      const SandPoint start = point_of(law, particle);
      for (int c = 0; c < 6; ++c) {
        s[c] = simd::broadcast(start.s[c]);
        e[c] = simd::broadcast(deviator(strain)[c]);
      }
      y[0] = {simd::broadcast(start.p_star),          simd::broadcast(start.eps_q),
              simd::broadcast(start.specific_volume), simd::broadcast(start.gap),
              simd::broadcast(-trace(strain)),        plane_of(s, e, Shear::any)};
      integrator.advance(y, end);
      if (end[0].done[0]) ++done;
      ++steps;
      particle.strain_by(strain);
    }
  }
  EXPECT_GT(done, 0.99 * steps);
}

TEST_P(SandPacks, leave_nan_where_an_increment_cannot_be_integrated) {
  const SandLaw law(sand());
  Particle particle(law, at_rest(9e3, 0.5));
  particle.strain_by(principal(1e-3, -2e-3, 1e-3), 100);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const std::array strains{principal(1e-6, -1e-6, 0.0), principal(nan, 0.0, 0.0),
                           principal(1e-6, -1e-6, 0.0), principal(0.0, infinite, 0.0),
                           SymmetricTensor{{0, 0, 0, nan, 0, 0}}};
  Sands together(law, strains.size());
  for (std::size_t p = 0; p < strains.size(); ++p) together.set(p, particle, strains[p]);
  together.update();
  for (std::size_t p : {0U, 2U}) EXPECT_TRUE(std::isfinite(norm(together.stress(p)))) << p;
  for (std::size_t p : {1U, 3U, 4U}) EXPECT_TRUE(std::isnan(norm(together.stress(p)))) << p;
}

TEST_P(SandPacks, wave_modulus_is_that_of_each_particle) {
  const SandLaw law(sand());
  const SandElasticity& elasticity = law.surface().elasticity();
  const std::vector<Case> all = cases(law, 41, 1);
  Sands together(law, 7);
  for (std::size_t p = 0; p < 7; ++p) together.set(p, all[15 * p].particle, {});
  std::array<double, 8> modulus{};
  law.wave_modulus(together.batch(), std::span(modulus).first(7));
  for (std::size_t p = 0; p < 7; ++p) {
    const double p_star = std::max(law.invariants(together.stress(p)).p_star, 10.0);
    const double expected =
        elasticity.bulk_modulus(p_star) + 4.0 / 3.0 * elasticity.shear_modulus(p_star);
    EXPECT_NEAR(modulus[p], expected, 1e-13 * expected);
  }
  EXPECT_EQ(modulus[7], 0.0);
}

}  // namespace
}  // namespace mpm::material
