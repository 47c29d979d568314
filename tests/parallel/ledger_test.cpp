#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/material/VonMises.hpp"
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

double entry(const LedgerReport<2>& report, const std::string& name) {
  for (const auto& [key, value] : entries(report))
    if (key == name) return value;
  return std::numeric_limits<double>::quiet_NaN();
}

// Strain energy -----------------------------------------------------------------------------------

TEST(Ledger, strain_energy_of_a_block_under_known_stress_has_its_closed_form) {
  test::TimedSimulation<2> simulation(
      test::full_box<2>(test::equal_lines<2>(0.0, side, 8), grid::Wall::roller));
  test::set_stress<2>(simulation, {{-31.0, 22.0, -9.0, 0.0}});
  simulation.open_ledger();
  const SymmetricTensor stress{{-71.0, -42.0, -33.0, 18.0}};
  test::set_stress<2>(simulation, stress);
  const double E = test::soft.youngs_modulus, nu = test::soft.poisson_ratio;
  const auto energy = [&](const SymmetricTensor& s) {
    return side * side / (2 * E) * ((1 + nu) * contract(s, s) - nu * trace(s) * trace(s));
  };
  const LedgerReport<2> report = simulation.ledger();
  const double change = energy(stress) - energy({{-31.0, 22.0, -9.0, 0.0}});
  EXPECT_NEAR(report.strain_change.value(), change, 1e-12 * change);
  EXPECT_NEAR(report.plastic_work.value(), -change, 1e-12 * change);
  EXPECT_NEAR(entry(report, "strain_energy_change_J"), change, 1e-12 * change);
}

class WithoutPotential : public material::LinearElastic {
 public:
  WithoutPotential() : LinearElastic(test::soft) {}
  bool has_strain_energy() const override { return false; }
};

TEST(Ledger, has_no_strain_energy_where_a_law_has_none) {
  auto setup = test::full_box<2>(test::equal_lines<2>(0.0, side, 6), grid::Wall::roller);
  setup.materials.push_back(std::make_shared<WithoutPotential>());
  test::TimedSimulation<2> simulation(setup);
  const LedgerReport<2> report = simulation.ledger();
  EXPECT_FALSE(report.strain_change || report.plastic_work || report.dissipation);
  EXPECT_TRUE(std::isnan(entry(report, "strain_energy_change_J")));
  EXPECT_TRUE(std::isnan(entry(report, "plastic_work_J")));
  EXPECT_EQ(entry(report, "internal_work_J"), 0.0);
}

/// Returns what is amiss in internal work = -change of strain energy, as a share of the energy.
double energy_missing_in_a_bar(double courant) {
  auto setup = test::full_box<1>(test::equal_lines<1>(0.0, side, 30), grid::Wall::fixed);
  setup.courant = courant;
  test::TimedSimulation<1> simulation(setup);
  test::set_velocity<1>(simulation, [](const Vector<1>& x) {
    return Vector<1>{1e-3 * std::sin(3.141592653589793 * x[0] / side)};
  });
  simulation.open_ledger();
  const double start = simulation.kinetic_energy();
  while (simulation.time() < 0.2) simulation.advance(0.2 - simulation.time());
  const LedgerReport<1> report = simulation.ledger();
  EXPECT_LT(report.kinetic_change, -0.2 * start);
  EXPECT_NEAR(report.internal_work, report.kinetic_change, 2e-3 * start);
  EXPECT_GT(report.strain_change.value(), 0.2 * start);
  EXPECT_NEAR(report.dissipation.value(), -report.kinetic_change - *report.strain_change,
              1e-12 * start);
  return std::abs(report.internal_work + *report.strain_change) / start;
}

TEST(Ledger, internal_work_of_a_vibrating_bar_is_stored_as_strain_energy) {
  const double coarse = energy_missing_in_a_bar(0.2), fine = energy_missing_in_a_bar(0.05);
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(fine, 0.3 * coarse);
}

// Plastic work ------------------------------------------------------------------------------------

/// A block in the middle of a grid whose nodes are sheared as a whole.
SimulationSetup<2> sheared_block(const material::VonMisesParameters& parameters) {
  SimulationSetup<2> setup{.lines = test::equal_lines<2>(0.0, side, 14)};
  setup.materials = {std::make_shared<material::VonMises>(parameters)};
  setup.filling = {[](const Vector<2>& x) {
                     return x[0] > 0.4 && x[0] < 0.9 && x[1] > 0.5 && x[1] < 0.8 ? std::optional(0)
                                                                                 : std::nullopt;
                   },
                   [](const auto&) { return 2; }};
  setup.courant = 0.3;
  return setup;
}

/// Sum of sigma_y eps_p V.
double plastic_work_of_particles(const Simulation<2>& simulation, double yield_stress) {
  const auto view = simulation.particles().view();
  const double* strain = view[simulation.particles().state(0, "plastic_strain")];
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) sum += yield_stress * strain[p] * view.volume[p];
  return petsc::sum(sum);
}

/// To 3 %: beside the edges of the block nodes are given a little more than its own motion.
TEST(Ledger, plastic_work_of_sheared_clay_is_yield_stress_times_plastic_strain) {
  const material::VonMisesParameters clay{
      .elastic = {.youngs_modulus = 2.7e6, .poisson_ratio = 0.35, .density = 1700.0},
      .shear_strength = 6.1e3};
  constexpr double rate = 0.7;
  test::TimedSimulation<2> simulation(sheared_block(clay));
  const test::Gradient<2> L{{{0.0, rate}, {0.0, 0.0}}};
  simulation.add_constraint(std::make_shared<test::PrescribedGradient<2>>(L));
  test::set_velocity<2>(simulation, [&](const auto& x) { return test::linear_velocity<2>(L, x); });
  simulation.open_ledger();
  while (simulation.time() < 0.04) simulation.advance();
  const LedgerReport<2> report = simulation.ledger();
  const double c = clay.shear_strength;
  const double G = clay.elastic.youngs_modulus / (2.0 * (1.0 + clay.elastic.poisson_ratio));
  const double plastic = plastic_work_of_particles(simulation, std::sqrt(3.0) * c);
  const double stored = 0.5 * c * c / G * simulation.total_mass() / 1700.0;
  EXPECT_GT(plastic, 2.0 * stored);
  EXPECT_NEAR(report.plastic_work.value(), plastic, 0.03 * plastic);
  EXPECT_NEAR(report.strain_change.value(), stored, 0.005 * stored);
  EXPECT_NEAR(named(report, "constraint").work, plastic + stored, 0.03 * plastic);
}

// Bodies ------------------------------------------------------------------------------------------

constexpr double slope = 0.42, friction = 0.21;  // rad; mu

/// A stiff block on a plane that moves along itself; x runs down the slope.
struct SlidingBlock {
  static constexpr double cell = 0.1, bottom = 0.3, rho = 1900.0;

  explicit SlidingBlock(double plane_velocity) : simulation(setup()) {
    body = test::rigid_body<2>(geometry::HalfSpace<2>({0.0, 1.0}), {0.0, bottom},
                               {plane_velocity, 0.0});
    simulation.add_constraint(std::make_shared<contact::RigidContact<2>>(
        simulation.grid(), simulation.walls(), simulation.step().point_deposit(), body,
        contact::ContactOptions{
            .gap_cells = 0.01, .friction = friction, .reference_density = rho}));
  }

  static SimulationSetup<2> setup() {
    SimulationSetup<2> setup{.lines = {basis::KnotLines::uniform(0.0, 2.0, 20),
                                       basis::KnotLines::uniform(0.0, 1.2, 12)}};
    setup.materials = {
        test::elastic({.youngs_modulus = 3e6, .poisson_ratio = 0.25, .density = rho})};
    setup.filling = {[](const Vector<2>& x) {
                       return x[0] > 0.3 && x[0] < 0.9 && x[1] > bottom && x[1] < bottom + 0.3
                                  ? std::optional(0)
                                  : std::nullopt;
                     },
                     [](const auto&) { return 2; }};
    setup.courant = 0.25;
    return setup;
  }

  /// Comes to rest on the plane, which holds it until it is let go along the slope with the
  /// velocity v.
  void settle(double v) {
    const double along = std::exchange(body->velocity[0], 0.0);
    simulation.set_gravity({0.0, -g * std::cos(slope)});
    simulation.set_damping(0.4);
    for (int k = 0; k < 1500; ++k) simulation.advance();
    simulation.set_damping(0.0);
    simulation.set_gravity({g * std::sin(slope), -g * std::cos(slope)});
    body->velocity[0] = along;
    test::set_velocity<2>(simulation, [&](const auto&) { return Vector<2>{v, 0.0}; });
    simulation.open_ledger();
  }
  /// Returns how far the block has slid along x.
  double slide(double seconds) {
    double way = 0.0;
    for (const double end = simulation.time() + seconds; simulation.time() < end;) {
      simulation.advance(end - simulation.time());
      way += simulation.momentum()[0] / simulation.total_mass() * simulation.times.dt;
    }
    return way;
  }

  test::TimedSimulation<2> simulation;
  std::shared_ptr<contact::RigidBody<2>> body;
};

/// Friction takes mu m g cos a over the way along the plane, whichever frame the plane is seen
/// from; what else the body is given is the work of the plane's motion.
TEST(Ledger, friction_work_of_a_sliding_block_is_friction_times_way_over_the_plane) {
  constexpr double seconds = 0.3, first_velocity = 0.5;
  for (const double plane : {0.0, 0.37}) {
    SCOPED_TRACE(plane);
    SlidingBlock block(plane);
    block.settle(first_velocity + plane);
    const double way = block.slide(seconds) - plane * seconds;
    const LedgerReport<2> report = block.simulation.ledger();
    const double friction_force = friction * block.simulation.total_mass() * g * std::cos(slope);
    EXPECT_GT(way, 0.2);
    EXPECT_NEAR(report.friction_work.value(), -friction_force * way, 0.02 * friction_force * way);
    EXPECT_NEAR(report.work_of_bodies.value(), -friction_force * plane * seconds,
                0.02 * friction_force * way);
    EXPECT_NEAR(named(report, "contact").work, *report.work_of_bodies + *report.friction_work,
                1e-12 * friction_force * way);
  }
}

TEST(Ledger, without_bodies_has_neither_their_work_nor_friction) {
  test::TimedSimulation<2> simulation(loaded_block(basis::Kind::cubic, grid::Wall::roller));
  const LedgerReport<2> report = simulation.ledger();
  EXPECT_FALSE(report.work_of_bodies || report.friction_work);
  EXPECT_TRUE(std::isnan(entry(report, "friction_work_J")));
}

// Body force --------------------------------------------------------------------------------------

/// Returns what is amiss in work of the body force = change of kinetic and of strain energy.
double body_force_work_missing(double courant) {
  auto setup = test::full_box<1>(test::equal_lines<1>(0.0, side, 40), grid::Wall::fixed, 4);
  setup.materials = {std::make_shared<material::NeoHookean>(material::NeoHookeanParameters{
      .youngs_modulus = 7.3e3, .poisson_ratio = 0.2, .density = 1.7})};
  setup.courant = courant;
  test::TimedSimulation<1> simulation(setup);
  simulation.set_body_force([](const Vector<1>& X, double t) {
    return Vector<1>{900.0 * (1.0 + 3.0 * t) * std::sin(2.0 * 3.141592653589793 * X[0] / side)};
  });
  simulation.open_ledger();
  while (simulation.time() < 0.006) simulation.advance(0.006 - simulation.time());
  const LedgerReport<1> report = simulation.ledger();
  const double work = report.causes.front().work;
  EXPECT_EQ(report.causes.front().name, "gravity");
  EXPECT_GT(work, 0.0);
  EXPECT_GT(report.strain_change.value(), 0.1 * work);
  EXPECT_GT(report.kinetic_change, 0.1 * work);
  return std::abs(work - report.kinetic_change - *report.strain_change) / work;
}

TEST(Ledger, work_of_a_body_force_at_undeformed_positions_is_kinetic_and_strain_energy) {
  const double coarse = body_force_work_missing(0.2), fine = body_force_work_missing(0.05);
  EXPECT_LT(coarse, 0.03);
  EXPECT_LT(fine, 0.3 * coarse);
}

/// A uniform body force is the same as gravity, to the work it does beside walls.
TEST(Ledger, work_of_a_uniform_body_force_is_that_of_gravity) {
  test::for_every_basis([](basis::Kind basis) {
    std::array<double, 2> work{};
    for (const bool as_field : {false, true}) {
      SimulationSetup<2> setup = loaded_block(basis, grid::Wall::fixed);
      const Vector<2> force = setup.gravity;
      if (as_field) setup.gravity = {};
      test::TimedSimulation<2> simulation(setup);
      if (as_field) simulation.set_body_force([&](const Vector<2>&, double) { return force; });
      load_top(simulation);
      simulation.open_ledger();
      for (int k = 0; k < 40; ++k) simulation.advance();
      work[as_field ? 1 : 0] = named(simulation.ledger(), "gravity").work;
    }
    EXPECT_NEAR(work[1], work[0], 1e-10 * std::abs(work[0]));
  });
}

// Rows --------------------------------------------------------------------------------------------

TEST(Ledger, has_the_same_entries_at_the_start_and_later) {
  SlidingBlock block(0.1);
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& [name, value] : entries(block.simulation.ledger())) all.push_back(name);
    return all;
  };
  const std::vector<std::string> first = names();
  for (int k = 0; k < 3; ++k) block.simulation.advance();
  EXPECT_EQ(names(), first);
  const std::vector<std::string> expected{
      "impulse_gravity_x_N_s", "impulse_gravity_y_N_s",   "work_gravity_J",
      "impulse_loads_x_N_s",   "impulse_loads_y_N_s",     "work_loads_J",
      "impulse_damping_x_N_s", "impulse_damping_y_N_s",   "work_damping_J",
      "impulse_contact_x_N_s", "impulse_contact_y_N_s",   "work_contact_J",
      "work_of_bodies_J",      "friction_work_J",         "momentum_residual",
      "internal_work_J",       "strain_energy_change_J",  "plastic_work_J",
      "dissipation_J",         "kinetic_energy_change_J", "kinetic_energy_residual_J"};
  EXPECT_EQ(first, expected);
}

TEST(Ledger, goes_on_from_what_was_saved) {
  SlidingBlock block(0.1), other(0.1);
  block.settle(0.6);
  block.slide(0.02);
  Archive taken;
  block.simulation.persist_ledger(taken);
  Archive given(taken.values());
  other.simulation.persist_ledger(given);
  const auto saved = block.simulation.ledger(), back = other.simulation.ledger();
  EXPECT_NE(saved.friction_work.value(), 0.0);
  EXPECT_EQ(back.friction_work.value(), saved.friction_work.value());
  EXPECT_LT(back.strain_change.value(), 0.0);  // unstressed, against the start of a settled block
  EXPECT_EQ(back.internal_work, saved.internal_work);
}

}  // namespace
}  // namespace mpm::solver
