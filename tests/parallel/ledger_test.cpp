#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mpm/contact/RigidContact.hpp"
#include "support/Scenes.hpp"

namespace mpm::solver {
namespace {

constexpr double side = 1.4, height = 0.9, g = 7.3;

/// A block between rollers or fixed walls on a fixed bottom, under gravity, with a load on its top.
SimulationSetup<2> loaded_block(basis::Kind basis, grid::Wall walls) {
  SimulationSetup<2> setup{
      .lines = {basis::KnotLines::uniform(0.0, side, 14), basis::KnotLines::uniform(0.0, 1.4, 14)}};
  setup.basis = basis;
  setup.walls = {{{walls, walls}, {grid::Wall::fixed, grid::Wall::free}}};
  setup.materials = {
      test::elastic({.youngs_modulus = 3e6, .poisson_ratio = 0.25, .density = test::soft.density})};
  setup.filling = {
      [](const Vector<2>& x) { return x[1] < height ? std::optional(0) : std::nullopt; },
      [](const auto&) { return 2; }};
  setup.gravity = {0.3 * g, -g};
  setup.courant = 0.3;
  return setup;
}

void load_top(Simulation<2>& simulation) {
  std::vector<particles::SurfacePiece<2>> top;
  for (int k = 0; k < 28; ++k)
    top.push_back({{0.025 + 0.05 * k, height - 0.025}, {0.0, 0.025}, {0.0, 0.05}, 35.0});
  simulation.boundary().add(top);
}

const Cause<2>& named(const LedgerReport<2>& report, const std::string& name) {
  for (const Cause<2>& cause : report.causes)
    if (cause.name == name) return cause;
  throw std::out_of_range(name);
}

void expect_closed(SimulationSetup<2> setup, const std::string& what) {
  SCOPED_TRACE(what);
  test::TimedSimulation<2> simulation(setup);
  load_top(simulation);
  simulation.set_damping(0.2);
  simulation.open_ledger();
  for (int k = 0; k < 60; ++k) simulation.advance();
  const LedgerReport<2> report = simulation.ledger();
  EXPECT_LT(report.momentum_residual_share, 1e-12);
  EXPECT_LT(named(report, "gravity").impulse[1], 0.0);
  EXPECT_GT(named(report, "wall_bottom").impulse[1], 0.0);
  EXPECT_LT(named(report, "loads").impulse[1], 0.0);
  EXPECT_LT(named(report, "damping").work, 0.0);
}

TEST(Ledger, momentum_closes_to_round_off_whatever_basis_and_walls) {
  test::for_every_basis([](basis::Kind basis) {
    for (const grid::Wall wall : {grid::Wall::roller, grid::Wall::fixed})
      expect_closed(loaded_block(basis, wall), wall == grid::Wall::fixed ? "fixed" : "roller");
  });
}

TEST(Ledger, momentum_closes_to_round_off_whatever_update_and_transfer) {
  for (const Scheme scheme : {Scheme::musl, Scheme::usl, Scheme::usf})
    for (const Transfer transfer : {Transfer::flip, Transfer::pic, Transfer::apic}) {
      SimulationSetup<2> setup = loaded_block(basis::Kind::cubic, grid::Wall::roller);
      setup.scheme = scheme;
      setup.transfer = transfer;
      expect_closed(setup, "update and transfer");
      setup.flip_time = 0.02;
      setup.ends = basis::EndTreatment::open_knot;
      expect_closed(setup, "with flip_time and open knots");
    }
}

TEST(Ledger, of_a_block_at_rest_has_the_bottom_carry_weight_and_load) {
  SimulationSetup<2> setup = loaded_block(basis::Kind::quadratic, grid::Wall::roller);
  setup.gravity = {0.0, -g};
  test::TimedSimulation<2> simulation(setup);
  load_top(simulation);
  simulation.set_damping(0.4);
  for (int k = 0; k < 4000; ++k) simulation.advance();
  simulation.open_ledger();
  double seconds = 0.0;
  for (int k = 0; k < 40; ++k) {
    simulation.advance();
    seconds += simulation.times.momentum_dt();
  }
  const LedgerReport<2> report = simulation.ledger();
  const double weight = simulation.total_mass() * g, load = 35.0 * side;
  EXPECT_NEAR(named(report, "gravity").impulse[1] / seconds, -weight, 1e-10 * weight);
  EXPECT_NEAR(named(report, "loads").impulse[1] / seconds, -load, 0.02 * load);
  EXPECT_NEAR(named(report, "wall_bottom").impulse[1] / seconds, weight + load, 0.01 * weight);
  EXPECT_NEAR(named(report, "wall_left").impulse[0] + named(report, "wall_right").impulse[0], 0.0,
              1e-6 * weight * seconds);
}

/// Gravity lifts nothing: what it does to a falling block is m g times the way.
TEST(Ledger, work_of_gravity_on_a_falling_block_is_weight_times_way) {
  SimulationSetup<2> setup = loaded_block(basis::Kind::cubic, grid::Wall::free);
  setup.walls = test::walls_all<2>(grid::Wall::free);
  setup.filling.material_at = [](const Vector<2>& x) {
    return std::abs(x[0] - 0.7) < 0.2 && x[1] > 0.8 && x[1] < 1.0 ? std::optional(0) : std::nullopt;
  };
  setup.gravity = {0.0, -g};
  test::TimedSimulation<2> simulation(setup);
  simulation.open_ledger();
  double seconds = 0.0;
  while (simulation.time() < 0.2) {
    simulation.advance(1e-3);
    seconds += simulation.times.momentum_dt();
  }
  const LedgerReport<2> report = simulation.ledger();
  const double weight = simulation.total_mass() * g, way = 0.5 * g * seconds * seconds;
  EXPECT_NEAR(named(report, "gravity").work, weight * way, 1e-10 * weight * way);
  EXPECT_NEAR(report.kinetic_change, weight * way, 1e-10 * weight * way);
  EXPECT_NEAR(report.internal_work, 0.0, 1e-10 * weight * way);
}

/// In an elastic body work of internal forces is what the strain energy loses.
TEST(Ledger, internal_work_of_a_vibrating_bar_is_the_change_of_its_kinetic_energy) {
  auto setup = test::full_box<1>(test::equal_lines<1>(0.0, side, 30), grid::Wall::fixed);
  setup.courant = 0.2;
  test::TimedSimulation<1> simulation(setup);
  test::set_velocity<1>(simulation, [](const Vector<1>& x) {
    return Vector<1>{1e-3 * std::sin(3.141592653589793 * x[0] / side)};
  });
  simulation.open_ledger();
  const double start = simulation.kinetic_energy();
  for (int k = 0; k < 120; ++k) simulation.advance();
  const LedgerReport<1> report = simulation.ledger();
  EXPECT_LT(report.kinetic_change, -0.2 * start);
  EXPECT_NEAR(report.internal_work, report.kinetic_change, 2e-3 * start);
}

}  // namespace
}  // namespace mpm::solver
