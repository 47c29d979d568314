#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/petsc/Session.hpp"
#include "support/Grids.hpp"
#include "support/Scenes.hpp"

// Ranks that hand cells over as a body moves, against a run on one rank.

namespace mpm::solver {
namespace {

using basis::KnotLines;
using grid::Wall;
using test::Snapshot;

constexpr double threshold = 1.1;
constexpr int collapse_steps = 300;

/// Calls check(method) for every way to share out cells, and names it where the check fails.
template <class Check>
void for_every_method(const Check& check) {
  for (const auto& [word, method] :
       {std::pair("ranges", LoadBalance::ranges), std::pair("metis", LoadBalance::metis)}) {
    SCOPED_TRACE(word);
    check(method);
  }
}

/// A column of sand that falls apart on a fixed base, the wall on its left taken away.
SimulationSetup<2> column(LoadBalance method) {
  SimulationSetup<2> setup{
      .lines = {KnotLines::uniform(0.0, 6.4, 64), KnotLines::uniform(0.0, 2.3, 23)}};
  setup.communicator = test::world();
  setup.walls = {{{Wall::symmetry, Wall::free}, {Wall::fixed, Wall::free}}};
  setup.materials = {std::make_shared<material::MohrCoulomb>(material::MohrCoulombParameters{
      .elastic = {.youngs_modulus = 2e5, .poisson_ratio = 0.3, .density = 1500.0},
      .friction_angle = 20.0})};
  setup.filling = {
      [](const Vector<2>& x) { return x[0] < 1.6 && x[1] < 2.0 ? std::optional(0) : std::nullopt; },
      [](const auto&) { return 2; }};
  setup.gravity = {0.0, -9.81};
  setup.balance = {.method = method, .rebalance_above = threshold, .steps_between_checks = 20};
  return setup;
}

/// A block of elastic material that flies through a box, a cell in every few steps.
template <int dim>
SimulationSetup<dim> flying_block(LoadBalance method) {
  auto setup = test::full_box<dim>(
      test::equal_lines<dim>(0.0, dim == 3 ? 1.4 : 3.9, dim == 3 ? 14 : 39), Wall::free);
  setup.filling.material_at = [](const Vector<dim>& x) {
    for (double component : x)
      if (component < 0.2 || component > (dim == 3 ? 0.7 : 1.4)) return std::optional<int>();
    return std::optional(0);
  };
  setup.balance = {.method = method, .rebalance_above = 1.02, .steps_between_checks = 5};
  return setup;
}

/// What is left of a run.
template <int dim>
struct Outcome {
  std::vector<Snapshot<dim>> particles;
  std::vector<double> nodal_mass;  ///< of the last step, in the order of the whole grid
  double mass = 0.0;
  double largest_imbalance = 0.0;  ///< after checks
  int rebalancings = 0;
};

/// The first component of a nodal field on all nodes of the grid. Collective.
template <int dim>
std::vector<double> on_all_nodes(const grid::Grid<dim>& grid, const grid::NodalField<dim>& field) {
  grid::Box<dim> all;
  for (int d = 0; d < dim; ++d) all.end[d] = grid.nodes(d).count();
  std::vector<double> values(static_cast<std::size_t>(all.size()), 0.0);
  const std::vector<double> mine = grid.to_record(field.values(0));
  grid.recorded_nodes().for_each([&](int k, const auto& node) {
    values[static_cast<std::size_t>(all.index_of(node))] = mine[static_cast<std::size_t>(k)];
  });
  grid.communicator().sum(values);
  return values;
}

template <int dim>
Outcome<dim> outcome_of(test::TimedSimulation<dim>& simulation, int steps,
                        int steps_between_checks) {
  Outcome<dim> outcome;
  for (int k = 0; k < steps; ++k) {
    simulation.advance();
    if (k > 0 && k % steps_between_checks == 0)
      outcome.largest_imbalance = std::max(outcome.largest_imbalance, simulation.imbalance());
  }
  outcome.particles = test::snapshots(simulation.particles());
  outcome.nodal_mass = on_all_nodes(simulation.grid(), simulation.step().nodal_sums());
  outcome.mass = simulation.total_mass();
  outcome.rebalancings = simulation.rebalancings();
  return outcome;
}

Outcome<2> collapse(LoadBalance method) {
  test::TimedSimulation<2> simulation(column(method));
  return outcome_of(simulation, collapse_steps, 20);
}

template <int dim>
Outcome<dim> flight(LoadBalance method, int steps) {
  auto setup = flying_block<dim>(method);
  if constexpr (dim == 3) setup.transfer = Transfer::apic;
  test::TimedSimulation<dim> simulation(setup);
  test::set_velocity<dim>(simulation, [](const Vector<dim>& x) {
    Vector<dim> v;
    for (int d = 0; d < dim; ++d) v[d] = 1.3 - 0.3 * d + 0.02 * std::sin(9 * x[(d + 1) % dim]);
    return v;
  });
  return outcome_of(simulation, steps, 5);
}

/// Within round-off that has grown over the run: `tolerance` of lengths of 1 m, speeds of 1 m/s
/// and stresses of `stress`.
template <int dim>
void expect_same(const Outcome<dim>& shared, const Outcome<dim>& serial, double tolerance,
                 double stress) {
  ASSERT_EQ(shared.particles.size(), serial.particles.size());
  EXPECT_NEAR(shared.mass / serial.mass, 1.0, 1e-13);
  for (std::size_t p = 0; p < serial.particles.size(); ++p) {
    const Snapshot<dim>&a = shared.particles[p], &b = serial.particles[p];
    ASSERT_EQ(a.id, b.id);
    for (int d = 0; d < dim; ++d) {
      ASSERT_NEAR(a.position[d], b.position[d], tolerance);
      ASSERT_NEAR(a.velocity[d], b.velocity[d], tolerance);
    }
    for (std::size_t k = 0; k < a.stress.size(); ++k)
      ASSERT_NEAR(a.stress[k], b.stress[k], tolerance * stress);
  }
  const double full = *std::ranges::max_element(serial.nodal_mass);
  for (std::size_t I = 0; I < serial.nodal_mass.size(); ++I)
    ASSERT_NEAR(shared.nodal_mass[I], serial.nodal_mass[I], tolerance * full);
}

TEST(Rebalancing, leaves_a_collapsing_column_as_it_is_on_one_rank) {
  for_every_method([](LoadBalance method) {
    const Outcome<2> shared = collapse(method);
    EXPECT_EQ(shared.rebalancings > 0, test::world_size() > 1);
    const test::SerialWorld alone;
    expect_same(shared, collapse(method), 1e-9, 3e4);
  });
}

TEST(Rebalancing, keeps_the_largest_load_below_the_threshold) {
  for_every_method([](LoadBalance method) {
    const Outcome<2> outcome = collapse(method);
    // A range takes whole columns of cells, of which there are few.
    const double possible = method == LoadBalance::ranges ? 1.25 : threshold + 0.02;
    EXPECT_LT(outcome.largest_imbalance, possible);
    auto setup = column(method);
    setup.balance.rebalance_above = 0.0;
    test::TimedSimulation<2> left_alone(setup);
    const Outcome<2> other = outcome_of(left_alone, collapse_steps, 20);
    EXPECT_EQ(other.rebalancings, 0);
    EXPECT_EQ(other.largest_imbalance > std::max(threshold, outcome.largest_imbalance),
              test::world_size() > 1);
  });
}

TEST(Rebalancing, follows_a_flying_block_without_changing_its_flight) {
  for_every_method([](LoadBalance method) {
    const Outcome<2> shared = flight<2>(method, 60);
    EXPECT_EQ(shared.rebalancings > 1, test::world_size() > 1);
    const test::SerialWorld alone;
    expect_same(shared, flight<2>(method, 60), 1e-11, 1e4);
  });
}

TEST(Rebalancing, works_in_one_and_three_dimensions) {
  for_every_method([](LoadBalance method) {
    const auto line = flight<1>(method, 60);
    const auto space = flight<3>(method, 15);
    EXPECT_EQ(line.rebalancings + space.rebalancings > 0, test::world_size() > 1);
    const test::SerialWorld alone;
    expect_same(line, flight<1>(method, 60), 1e-11, 1e4);
    expect_same(space, flight<3>(method, 15), 1e-11, 1e4);
  });
}

TEST(Rebalancing, repeats_itself_bit_for_bit) {
  for_every_method([](LoadBalance method) {
    const Outcome<2> first = collapse(method), second = collapse(method);
    EXPECT_EQ(first.rebalancings, second.rebalancings);
    ASSERT_EQ(first.particles.size(), second.particles.size());
    EXPECT_EQ(std::memcmp(first.particles.data(), second.particles.data(),
                          first.particles.size() * sizeof(Snapshot<2>)),
              0);
    EXPECT_EQ(first.nodal_mass, second.nodal_mass);
  });
}

/// A loaded block that is pushed along by a rigid plane: contact and boundary particles as well.
Outcome<2> pushed_block(LoadBalance method) {
  test::TimedSimulation<2> simulation(flying_block<2>(method));
  std::vector<particles::SurfacePiece<2>> top;
  for (int k = 0; k < 24; ++k)
    top.push_back({{0.225 + 0.05 * k, 1.375}, {0.0, 0.025}, {0.0, 0.05}, 2.0});
  simulation.boundary().add(top);
  const auto plane =
      test::rigid_body<2>(geometry::HalfSpace<2>({1.0, 0.0}), {0.16, 0.0}, {0.1, 0.0});
  const auto contact = std::make_shared<contact::RigidContact<2>>(
      simulation.grid(), simulation.walls(), simulation.step().point_deposit(), plane,
      contact::ContactOptions{.friction = 0.3, .reference_density = test::soft.density});
  simulation.add_constraint(contact);
  for (int k = 0; k < 150; ++k) {
    simulation.advance();
    plane->end_step(simulation.times.dt, simulation.times.momentum_dt());
  }
  return outcome_of(simulation, 10, 5);
}

TEST(Rebalancing, takes_boundary_particles_and_contact_along) {
  for_every_method([](LoadBalance method) {
    const Outcome<2> shared = pushed_block(method);
    EXPECT_EQ(shared.rebalancings > 0, test::world_size() > 1);
    const test::SerialWorld alone;
    const Outcome<2> serial = pushed_block(method);
    expect_same(shared, serial, 1e-9, 1e4);
    double right = 0.0;
    for (const auto& p : serial.particles) right = std::max(right, p.velocity[0]);
    EXPECT_GT(right, 0.05);  // it is pushed
  });
}

}  // namespace
}  // namespace mpm::solver
