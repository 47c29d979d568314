#include <gtest/gtest.h>

#include <cmath>

#include "mpm/contact/ContourReaction.hpp"
#include "mpm/contact/RigidContact.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/petsc/Session.hpp"
#include "support/Scenes.hpp"

namespace mpm::contact {
namespace {

using geometry::Ball;

/// Contact that pushes `factor` times as hard as it reports.
class Exaggerated : public grid::Constraint<2> {
 public:
  Exaggerated(std::shared_ptr<RigidContact<2>> contact, double factor)
      : m_contact(std::move(contact)), m_factor(factor) {}

  void find_nodes() override { m_contact->find_nodes(); }
  bool spares_from_damping() const override { return true; }
  grid::Booking<2>& booking() override { return m_contact->booking(); }
  void constrain(const grid::Grid<2>& grid, grid::ConstrainedNodes<2>& nodes) override {
    m_contact->constrain(grid, nodes);
    if (!nodes.is_momentum_update()) return;
    nodes.book_on(m_unreported);
    for (const auto& [I, given] : booking().changes) {
      const double more = (m_factor - 1.0) / nodes.mass(I);
      nodes.change_velocity(I, {more * given[0], more * given[1]});
    }
  }

 private:
  std::shared_ptr<RigidContact<2>> m_contact;
  double m_factor;
  grid::Booking<2> m_unreported;
};

/// A block with a hole under gravity, held by a rigid disc in the hole.
solver::SimulationSetup<2> block_with_hole(double radius) {
  const auto line = basis::KnotLines::uniform(-2.1, 2.1, 21);
  solver::SimulationSetup<2> setup{.lines = {line, line}};
  setup.walls = {{{grid::Wall::roller, grid::Wall::roller}, {grid::Wall::fixed, grid::Wall::free}}};
  setup.materials = {test::elastic({.youngs_modulus = 3e6, .poisson_ratio = 0.3, .density = 1700})};
  setup.filling = {[radius](const Vector<2>& x) {
                     const bool solid = x[1] < 1.5 && std::hypot(x[0], x[1]) > radius;
                     return solid ? std::optional(0) : std::nullopt;
                   },
                   [](const auto&) { return 2; }};
  setup.gravity = {0.0, -9.81};
  return setup;
}

/// Relative difference of the contour's reaction from the one that the contact reports.
double difference(double factor) {
  const double radius = 0.7;
  test::TimedSimulation<2> simulation(block_with_hole(radius));
  const auto disc = test::rigid_body<2>(Ball<2>(radius), {0.0, 0.0});
  const auto contact = std::make_shared<RigidContact<2>>(
      simulation.grid(), simulation.walls(), simulation.step().point_deposit(), disc,
      ContactOptions{.friction = 0.3, .reference_density = 1700.0});
  simulation.add_constraint(std::make_shared<Exaggerated>(contact, factor));
  simulation.set_damping(0.6);
  for (int k = 0; k < 1500; ++k) simulation.advance();
  disc->meter().take_impulse();
  ContourReaction<2> contour({.inner = 0.2, .outer = 0.75});
  contour.sample(simulation.particles().view(), *disc, simulation.gravity(), 0.0);
  contour.take_mean();
  double time = 0.0;
  for (int k = 0; k < 500; ++k) {
    simulation.advance();
    const double dt = simulation.times.momentum_dt();
    contour.sample(simulation.particles().view(), *disc, simulation.gravity(), dt);
    time += dt;
  }
  const double reported = petsc::sum(disc->meter().take_impulse()[1]) / time;
  return contour.take_mean().force[1] / reported - 1.0;
}

TEST(ContourReaction, agrees_with_the_impulses_that_contact_reports) {
  EXPECT_LT(std::abs(difference(1.0)), 0.03);
}

TEST(ContourReaction, tells_when_contact_pushes_harder_than_it_reports) {
  EXPECT_GT(std::abs(difference(1.1)), 0.06);
}

}  // namespace
}  // namespace mpm::contact
