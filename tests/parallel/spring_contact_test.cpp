#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "mpm/contact/SpringContact.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/petsc/Session.hpp"
#include "support/Grids.hpp"
#include "support/Scenes.hpp"

namespace mpm::contact {
namespace {

using basis::KnotLines;
using geometry::HalfSpace;
using grid::Wall;

constexpr double h = 0.1, bottom = 0.6, width = 0.6, height = 0.4;

/// A soft block above a plane that the block's own particles have to find.
struct BlockAbovePlane {
  BlockAbovePlane(basis::Kind basis, double plane_height, double gravity, double friction = 0.0)
      : simulation(setup(basis, gravity)) {
    const auto plane = test::rigid_body<2>(HalfSpace<2>({0.0, 1.0}), {0.0, plane_height});
    contact = std::make_shared<SpringContact<2>>(
        simulation.grid(), simulation.walls(), simulation.step().point_deposit(),
        simulation.particles(), plane, ContactOptions{.friction = friction, .label = "plane"});
    simulation.add_constraint(contact);
  }

  static solver::SimulationSetup<2> setup(basis::Kind basis, double gravity) {
    solver::SimulationSetup<2> setup{
        .lines = {KnotLines::uniform(0.0, 1.4, 14), KnotLines::uniform(0.0, 1.5, 15)}};
    setup.basis = basis;
    setup.walls = test::walls_all<2>(Wall::free);
    setup.materials = {test::elastic(
        {.youngs_modulus = 3e5, .poisson_ratio = 0.25, .density = test::soft.density})};
    setup.filling = {[](const Vector<2>& x) {
                       const bool inside = std::abs(x[0] - 0.7) < 0.5 * width && x[1] > bottom &&
                                           x[1] < bottom + height;
                       return inside ? std::optional(0) : std::nullopt;
                     },
                     [](const auto&) { return 2; }};
    setup.gravity = {0.0, -gravity};
    setup.courant = 0.5;
    setup.particle_contacts = {"plane"};
    return setup;
  }

  /// Upward on the block, over all ranks.
  double take_impulse() { return -petsc::sum(contact->body().meter().take_impulse()[1]); }

  test::TimedSimulation<2> simulation;
  std::shared_ptr<SpringContact<2>> contact;
};

TEST(SpringContact, starts_when_the_gap_is_closed_whatever_basis_and_offset) {
  constexpr double speed = 0.05, travel = 0.04;  // m/s, cells per step
  test::for_every_basis([&](basis::Kind basis) {
    for (double plane : {0.25, 0.271}) {
      BlockAbovePlane block(basis, plane, 0.0);
      test::set_velocity<2>(block.simulation, [&](const auto&) { return Vector<2>{0.0, -speed}; });
      double travelled = 0.0;
      while (travelled < bottom - plane + h) {
        block.simulation.advance(travel * h / speed);
        if (block.take_impulse() > 0.0) break;
        travelled = speed * block.simulation.time();
      }
      EXPECT_NEAR((bottom - plane - travelled) / h, 0.0, 1.05 * travel) << plane;
    }
  });
}

TEST(SpringContact, a_block_at_rest_presses_with_its_weight) {
  constexpr double gravity = 7.3;
  BlockAbovePlane block(basis::Kind::cubic, bottom, gravity);
  test::TimedSimulation<2>& simulation = block.simulation;
  simulation.set_damping(0.4);
  for (int k = 0; k < 3000; ++k) simulation.advance();
  block.take_impulse();
  double time = 0.0;
  for (int k = 0; k < 50; ++k) {
    simulation.advance();
    time += simulation.times.momentum_dt();
  }
  const double weight = test::soft.density * width * height * gravity;
  EXPECT_NEAR(block.take_impulse() / time, weight, 1e-3 * weight);
}

}  // namespace
}  // namespace mpm::contact
