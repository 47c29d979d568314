#include <gtest/gtest.h>

#include <cmath>

#include "mpm/core/Errors.hpp"
#include "mpm/material/SandLaw.hpp"
#include "mpm/run/WatchedParticle.hpp"
#include "support/Scenes.hpp"

namespace mpm::cases {
namespace {

constexpr double interface = 0.5;  // m, between the sand on the left and the elastic block

/// A box of sand and of an elastic material, which is listed first or second.
solver::Simulation<2> sand_and_block(bool block_is_first) {
  auto setup = test::full_box<2>(test::equal_lines<2>(0.0, 1.2, 12), grid::Wall::free);
  const auto sand = std::make_shared<material::SandLaw>(material::SandParameters{});
  setup.materials = {test::elastic(), sand};
  if (!block_is_first) std::swap(setup.materials[0], setup.materials[1]);
  const int of_sand = block_is_first ? 1 : 0;
  setup.filling.material_at = [of_sand](const Vector<2>& x) {
    return x[0] < interface ? of_sand : 1 - of_sand;
  };
  return solver::Simulation<2>(setup);
}

TEST(WatchedParticle, reads_the_state_of_its_own_law_in_either_order_of_the_laws) {
  for (const bool block_is_first : {false, true}) {
    auto simulation = sand_and_block(block_is_first);
    const SymmetricTensor stress{{-4e3, -7e3, -5e3, 1.5e3, 0.0, 0.0}};
    test::set_stress(simulation, stress);
    const auto& particles = simulation.particles();
    run::WatchedParticle<2> watched({0.31, 0.77}, {"void_ratio", "eps_q"});
    const run::Clock clock;
    watched.begin({simulation, clock});
    {
      const auto eps_q = particles.state(block_is_first ? 1 : 0, "eps_q");
      const auto view = particles.view();
      for (int p = 0; p < view.count; ++p) {
        view.volume[p] *= 0.9;
        view[eps_q][p] = view.position[0][p] < interface ? 10.0 * view.position[0][p] : -1.0;
      }
    }
    const run::Watched<2> seen = watched.observe(particles);
    EXPECT_NEAR(seen.position[0], 0.325, 1e-12);
    EXPECT_NEAR(seen.q, std::sqrt(7e6 + 3 * 1.5e3 * 1.5e3), 1e-6);
    EXPECT_NEAR(seen.p, 16e3 / 3.0, 1e-8);
    EXPECT_NEAR(seen.volumetric_strain, -std::log(0.9), 1e-14);
    ASSERT_EQ(seen.states.size(), 2u);
    EXPECT_EQ(seen.states[0], material::SandParameters{}.void_ratio);
    EXPECT_NEAR(seen.states[1], 3.25, 1e-12);  // the particle at x = 0.325
  }
}

TEST(WatchedParticle, of_a_law_without_the_state_that_is_asked_for_is_refused) {
  auto simulation = sand_and_block(true);
  const run::Clock clock;
  EXPECT_THROW(run::WatchedParticle<2>({0.9, 0.4}, {"void_ratio"}).begin({simulation, clock}),
               BadInput);
}

}  // namespace
}  // namespace mpm::cases
