#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/contact/SpringContact.hpp"
#include "mpm/geometry/Box.hpp"
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

enum class Kind { nodes_by_vote, springs };

/// A soft block above a plane that the block's own particles have to find.
struct BlockAbovePlane {
  BlockAbovePlane(Kind kind, basis::Kind basis, double plane_height, double gravity)
      : simulation(setup(basis, gravity)),
        plane(test::rigid_body<2>(HalfSpace<2>({0.0, 1.0}), {0.0, plane_height})) {
    simulation.add_constraint(contact(kind));
  }

  std::shared_ptr<grid::Constraint<2>> contact(Kind kind) {
    const ContactOptions options{.detection = detection_named("particle"),
                                 .reference_density = test::soft.density,
                                 .label = "plane"};
    const auto& deposit = simulation.step().point_deposit();
    if (kind == Kind::springs)
      return std::make_shared<SpringContact<2>>(simulation.grid(), simulation.walls(), deposit,
                                                simulation.particles(), plane, options);
    const auto voted = std::make_shared<RigidContact<2>>(simulation.grid(), simulation.walls(),
                                                         deposit, plane, options);
    voted->watch(simulation.particles());
    return voted;
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
  double take_impulse() { return -petsc::sum(plane->meter().take_impulse()[1]); }

  test::TimedSimulation<2> simulation;
  std::shared_ptr<RigidBody<2>> plane;
};

class ParticleContact : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, ParticleContact,
                         testing::Values(Kind::nodes_by_vote, Kind::springs));

TEST_P(ParticleContact, starts_when_the_gap_is_closed_whatever_basis_and_offset) {
  constexpr double speed = 0.05, travel = 0.04;  // m/s, cells per step
  test::for_every_basis([&](basis::Kind basis) {
    for (double plane : {0.25, 0.271}) {
      BlockAbovePlane block(GetParam(), basis, plane, 0.0);
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

TEST_P(ParticleContact, a_block_at_rest_presses_with_its_weight) {
  constexpr double gravity = 7.3;
  BlockAbovePlane block(GetParam(), basis::Kind::cubic, bottom, gravity);
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

void set_pressure(test::TimedSimulation<2>& simulation, double pressure) {
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    for (std::size_t c = 0; c < 3; ++c) view.stress[c][p] = -pressure;
}

/// Soil under stress beside the corner where two bodies meet: neither may disturb the other's
/// springs, whose first forces are those of the stress.
TEST(SpringContact, bodies_that_meet_at_a_corner_do_not_push_at_the_start) {
  constexpr double pressure = 2e4, side = 0.4;  // Pa, m
  solver::SimulationSetup<2> setup = BlockAbovePlane::setup(basis::Kind::cubic, 0.0);
  setup.particle_contacts = {"above", "below"};
  test::TimedSimulation<2> simulation(setup);
  set_pressure(simulation, pressure);
  std::vector<std::shared_ptr<RigidBody<2>>> bodies;
  for (const double up : {1.0, -1.0}) {
    const char* const label = up > 0.0 ? "above" : "below";
    bodies.push_back(
        test::rigid_body<2>(geometry::Box<2>({-0.5 * side, -0.5 * side}, {0.5 * side, 0.5 * side}),
                            {0.4 - 0.5 * side, 0.8 + 0.5 * up * side}));
    simulation.add_constraint(std::make_shared<SpringContact<2>>(
        simulation.grid(), simulation.walls(), simulation.step().point_deposit(),
        simulation.particles(), bodies.back(), ContactOptions{.label = label}));
  }
  for (int k = 0; k < 3; ++k) {
    simulation.advance(1e-6);
    for (const auto& body : bodies) {
      const double force =
          -petsc::sum(body->meter().take_impulse()[0]) / simulation.times.momentum_dt();
      EXPECT_NEAR(force, pressure * 0.5 * height, 0.2 * pressure * height) << k;
    }
  }
}

}  // namespace
}  // namespace mpm::contact
