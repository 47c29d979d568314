#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Session.hpp"
#include "support/Grids.hpp"
#include "support/Scenes.hpp"

namespace mpm::solver {
namespace {

using basis::KnotLines;
using grid::Wall;
using test::equal_lines;
using test::Gradient;
using test::linear_velocity;
using test::run_steps;
using test::Snapshot;

/// Calls check(scheme, kind) for every scheme with every basis, and names them where it fails.
template <class Check>
void for_every_scheme_and_basis(const Check& check) {
  const std::array<std::pair<const char*, Scheme>, 3> schemes{
      {{"musl", Scheme::musl}, {"usl", Scheme::usl}, {"usf", Scheme::usf}}};
  for (const auto& [word, scheme] : schemes) {
    SCOPED_TRACE(word);
    test::for_every_basis([&, scheme = scheme](basis::Kind kind) { check(scheme, kind); });
  }
}

/// A share of h/(c + |v|) at which free surfaces stay whole: usl tears them at half of it.
double courant_of(Scheme scheme) {
  return scheme == Scheme::usl ? 0.2 : 0.9;
}

// Patch test ------------------------------------------------------------------------------------

/// Largest nodal force after two steps under constant stress, as a share of stress times cell face.
template <int dim>
double patch_residual(SimulationSetup<dim> setup, const SymmetricTensor& stress) {
  test::TimedSimulation<dim> simulation(setup);
  test::set_stress(simulation, stress);
  run_steps(simulation, 2, 1e-13);
  const grid::NodalField<dim>& sums = simulation.step().nodal_sums();
  double largest = 0.0, face = 1.0;
  simulation.grid().for_each_owned_node([&](int I, const auto&) {
    for (int d = 0; d < dim; ++d)
      largest = std::max(largest, std::abs(sums.values(1 + dim + d)[I]));
  });
  for (int d = 1; d < dim; ++d) face *= setup.lines[d].smallest_width();
  return petsc::maximum(largest) / (norm(stress) * face);
}

const SymmetricTensor normal_stress{{-3e4, -2e4, -1.7e4, 0.0, 0.0, 0.0}};
const SymmetricTensor any_stress{{-3e4, -2e4, -1.7e4, 0.9e4, -0.4e4, 0.7e4}};

template <int dim>
void constant_stress_leaves_no_force(basis::Kind kind, const std::array<KnotLines, dim>& lines) {
  for (int per_direction : {1, 2, 3}) {
    auto rollers = test::full_box<dim>(lines, Wall::roller, per_direction);
    rollers.basis = kind;
    EXPECT_LT(patch_residual(rollers, normal_stress), 1e-12);
    auto fixed = rollers;
    fixed.walls = test::walls_all<dim>(Wall::fixed);
    EXPECT_LT(patch_residual(fixed, any_stress), 1e-12);
    auto mixed = rollers;
    mixed.walls[0][0] = Wall::symmetry;
    mixed.walls[dim - 1][1] = Wall::fixed;
    EXPECT_LT(patch_residual(mixed, normal_stress), 1e-12);
  }
}

TEST(PatchTest, constant_stress_leaves_no_force_at_mirrored_walls) {
  test::for_every_basis([](basis::Kind kind) {
    constant_stress_leaves_no_force<1>(kind, equal_lines<1>(-0.3, 3.9, 13));
    constant_stress_leaves_no_force<2>(kind, equal_lines<2>(-0.3, 2.1, 9));
    constant_stress_leaves_no_force<3>(kind, equal_lines<3>(-0.3, 1.4, 6));
  });
}

TEST(PatchTest, constant_stress_leaves_no_force_with_any_scheme) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    auto setup = test::full_box<2>(equal_lines<2>(-0.3, 2.1, 9), Wall::roller);
    setup.basis = kind;
    setup.scheme = scheme;
    EXPECT_LT(patch_residual(setup, normal_stress), 1e-12);
    setup.walls = test::walls_all<2>(Wall::fixed);
    EXPECT_LT(patch_residual(setup, any_stress), 1e-12);
  });
}

TEST(PatchTest, gimp_particles_that_fill_graded_cells_leave_no_force) {
  const std::array lines{test::graded_lines(9), test::graded_lines(11)};
  for (int per_direction : {2, 3}) {
    auto setup = test::full_box<2>(lines, Wall::roller, per_direction);
    setup.basis = basis::Kind::gimp;
    setup.particles_per_cell = per_direction;
    EXPECT_LT(patch_residual(setup, normal_stress), 1e-12);
  }
}

TEST(PatchTest, linear_and_quadratic_splines_need_no_gauss_points_on_graded_lines) {
  for (const basis::Kind kind : {basis::Kind::linear, basis::Kind::quadratic})
    constant_stress_leaves_no_force<2>(kind, {test::graded_lines(9), test::graded_lines(11)});
}

TEST(PatchTest, gauss_points_pass_on_graded_lines_and_midpoints_do_not) {
  const std::array lines{test::graded_lines(9), test::graded_lines(11)};
  auto gauss = test::full_box<2>(lines, Wall::roller);
  gauss.filling.placement = particles::Placement::gauss;
  EXPECT_LT(patch_residual(gauss, normal_stress), 1e-12);
  EXPECT_GT(patch_residual(test::full_box<2>(lines, Wall::roller), normal_stress), 1e-3);
}

TEST(PatchTest, stress_along_a_roller_is_not_carried_by_it) {
  EXPECT_GT(
      patch_residual(test::full_box<2>(equal_lines<2>(0.0, 1.8, 9), Wall::roller), any_stress),
      1e-3);
}

TEST(PatchTest, open_knots_leave_their_known_residual) {
  for (int per_cell : {1, 2, 3, 5}) {
    const int cells = 13;
    auto setup = test::full_box<1>(equal_lines<1>(-0.7, 3.2, cells), Wall::free, per_cell);
    setup.ends = basis::EndTreatment::open_knot;
    test::TimedSimulation<1> simulation(setup);
    const double sigma = 2.3e4;
    test::set_stress(simulation, {{sigma, 0.0, 0.0, 0.0, 0.0, 0.0}});
    run_steps(simulation, 1, 1e-13);
    const double* force = simulation.step().nodal_sums().values(2);
    simulation.grid().for_each_owned_node([&](int I, const std::array<int, 1>& node) {
      const int last = cells + 2;
      const int k = std::min(node[0], last - node[0]);
      const double side = node[0] == k ? 1.0 : -1.0;
      const std::array<double, 3> known{0.25, -0.375, 0.125};
      // f = -integral of sigma dN/dx, which is sigma at the first function and zero inside.
      const double exact = k == 0 ? sigma : 0.0;
      const double residual = k < 3 ? sigma * known[static_cast<std::size_t>(k)] : 0.0;
      EXPECT_NEAR(side * force[I], exact - residual / (per_cell * per_cell), 1e-12 * sigma)
          << "node " << node[0];
    });
  }
}

// Velocity fields -------------------------------------------------------------------------------

/// Checks the strain of one step, as if one of the same length came before, and the motion on
/// particles that no free surface is near to.
template <int dim>
void linear_field_is_reproduced(const SimulationSetup<dim>& setup, const Gradient<dim>& L,
                                const std::function<bool(const Vector<dim>&)>& is_inside) {
  test::TimedSimulation<dim> simulation(setup);
  test::set_velocity<dim>(simulation, [&](const auto& x) { return linear_velocity<dim>(L, x); });
  const double dt = 1e-5;
  simulation.assume_last_step(dt);
  run_steps(simulation, 1, dt);
  const double E = test::soft.youngs_modulus, nu = test::soft.poisson_ratio;
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = 0.5 * E / (1 + nu);
  int inside = 0;
  for (const Snapshot<dim>& p : test::snapshots(simulation.particles())) {
    if (!is_inside(p.start)) continue;
    ++inside;
    const Vector<dim> v = linear_velocity<dim>(L, p.start);
    double divergence = 0.0;
    for (int i = 0; i < dim; ++i) divergence += L[i][i];
    for (int i = 0; i < dim; ++i) {
      EXPECT_NEAR(p.velocity[i], v[i], 1e-12);
      EXPECT_NEAR(p.position[i], p.start[i] + v[i] * dt, 1e-14);
      EXPECT_NEAR(p.stress[i] / E, (lambda * divergence + 2 * mu * L[i][i]) / E * dt, 1e-12 * dt);
    }
    if constexpr (dim >= 2) {
      EXPECT_NEAR(p.stress[3] / E, mu * (L[0][1] + L[1][0]) / E * dt, 1e-12 * dt);
    }
    if constexpr (dim == 3) {
      EXPECT_NEAR(p.stress[4] / E, mu * (L[1][2] + L[2][1]) / E * dt, 1e-12 * dt);
      EXPECT_NEAR(p.stress[5] / E, mu * (L[0][2] + L[2][0]) / E * dt, 1e-12 * dt);
    }
  }
  EXPECT_GT(inside, 0);
}

template <int dim>
SimulationSetup<dim> free_box(basis::Kind kind) {
  auto setup = test::full_box<dim>(equal_lines<dim>(-1.3, 1.3, 13), Wall::free);
  setup.basis = kind;
  return setup;
}

TEST(LinearVelocity, is_reproduced_inside_a_body) {
  const auto within = [](double reach) {
    return [reach](const auto& x) {
      return std::ranges::all_of(x, [&](double component) { return std::abs(component) < reach; });
    };
  };
  test::for_every_basis([&](basis::Kind kind) {
    linear_field_is_reproduced<1>(free_box<1>(kind), {{{0.7}}}, within(0.5));
    linear_field_is_reproduced<2>(free_box<2>(kind), {{{0.7, -0.3}, {1.1, 0.4}}}, within(0.5));
    linear_field_is_reproduced<3>(
        free_box<3>(kind), {{{0.7, -0.3, 0.2}, {1.1, 0.4, -0.6}, {-0.8, 0.35, 0.9}}}, within(0.3));
  });
}

/// The forces of usf already know the step's strains: free surfaces reach two supports deep.
TEST(LinearVelocity, is_reproduced_with_any_scheme) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    auto setup = free_box<2>(kind);
    setup.scheme = scheme;
    const double reach = scheme == Scheme::usf ? 0.1 : 0.5;
    linear_field_is_reproduced<2>(setup, {{{0.7, -0.3}, {1.1, 0.4}}}, [reach](const auto& x) {
      return std::max(std::abs(x[0]), std::abs(x[1])) < reach;
    });
  });
}

TEST(LinearVelocity, is_reproduced_up_to_mirrored_walls) {
  auto setup = test::full_box<2>(equal_lines<2>(0.0, 2.6, 13), Wall::free, 3);
  setup.walls[0][0] = Wall::roller;
  setup.walls[1][0] = Wall::symmetry;
  test::for_every_basis([&](basis::Kind kind) {
    setup.basis = kind;
    linear_field_is_reproduced<2>(setup, {{{0.7, 0.0}, {0.0, -0.45}}},
                                  [](const auto& x) { return x[0] < 1.4 && x[1] < 1.4; });
  });
}

// Free motion -----------------------------------------------------------------------------------

/// A block amid air that may fly some cells far.
SimulationSetup<2> flying_block(basis::Kind kind) {
  auto setup = free_box<2>(kind);
  setup.filling.material_at = [](const Vector<2>& x) {
    return std::abs(x[0]) < 0.5 && std::abs(x[1] + 0.3) < 0.35 ? std::optional(0) : std::nullopt;
  };
  return setup;
}

TEST(RigidTranslation, leaves_no_stress_and_no_particle_behind) {
  test::for_every_basis([](basis::Kind kind) {
    test::TimedSimulation<2> simulation(flying_block(kind));
    const Vector<2> v{-0.17, 0.31};
    test::set_velocity<2>(simulation, [&](const auto&) { return v; });
    while (simulation.time() < 1.7) simulation.advance();
    for (const Snapshot<2>& p : test::snapshots(simulation.particles())) {
      for (int d : {0, 1}) EXPECT_NEAR(p.position[d], p.start[d] + v[d] * simulation.time(), 1e-12);
      for (double component : p.stress)
        EXPECT_NEAR(component / test::soft.youngs_modulus, 0, 1e-12);
    }
  });
}

void momentum_of_a_shaken_body_stays(const SimulationSetup<2>& setup) {
  test::TimedSimulation<2> simulation(setup);
  test::set_velocity<2>(simulation, [&](const Vector<2>& x) {
    return Vector<2>{-0.1 + 0.05 * std::sin(9 * x[1]), 0.2 + 0.03 * std::cos(11 * x[0])};
  });
  test::set_stress(simulation, 1e-3 * any_stress);
  const Vector<2> before = simulation.momentum();
  const double energy = simulation.kinetic_energy(), size = std::hypot(before[0], before[1]);
  for (int k = 0; k < 60; ++k) simulation.advance();
  EXPECT_GT(std::abs(simulation.kinetic_energy() / energy - 1.0), 1e-3);
  for (int d : {0, 1}) EXPECT_NEAR(simulation.momentum()[d], before[d], 1e-13 * size);
}

TEST(Momentum, of_a_body_that_shakes_on_its_way_stays) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    auto setup = flying_block(kind);
    setup.scheme = scheme;
    setup.courant = courant_of(scheme);
    momentum_of_a_shaken_body_stays(setup);
  });
}

TEST(Momentum, stays_where_velocities_turn_into_those_of_the_grid) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    auto setup = flying_block(kind);
    setup.scheme = scheme;
    setup.courant = courant_of(scheme);
    for (double flip_time : {0.4, 0.0}) {
      setup.flip_time = flip_time;
      momentum_of_a_shaken_body_stays(setup);
    }
  });
}

// Rigid rotation --------------------------------------------------------------------------------

template <int dim>
double stress_norm(const Snapshot<dim>& p) {
  SymmetricTensor s;
  for (int k = 0; k < tensor_components<dim>; ++k) s[k] = p.stress[static_cast<std::size_t>(k)];
  return norm(s);
}

/// One turn in 1000 steps. `omega` is the size of the spin, rad/s.
template <int dim>
void turn_keeps_stress_and_volume(basis::Kind kind, const Gradient<dim>& spin, double omega) {
  auto setup = free_box<dim>(kind);
  setup.filling.material_at = [](const Vector<dim>& x) {
    double square = 0.0;
    for (double component : x) square += component * component;
    return square < 0.16 ? std::optional(0) : std::nullopt;
  };
  test::TimedSimulation<dim> simulation(setup);
  simulation.add_constraint(std::make_shared<test::PrescribedGradient<dim>>(spin));
  test::set_stress(simulation, any_stress);
  const auto before = test::snapshots(simulation.particles());
  run_steps(simulation, 500, 2 * std::numbers::pi / omega / 1000);
  const auto half = test::snapshots(simulation.particles());
  EXPECT_GT(std::abs(half[0].position[1] - before[0].position[1]), 0.3);
  run_steps(simulation, 500, 2 * std::numbers::pi / omega / 1000);
  const auto after = test::snapshots(simulation.particles());
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t p = 0; p < after.size(); ++p) {
    EXPECT_NEAR(stress_norm(after[p]) / stress_norm(before[p]), 1.0, 1e-12);
    EXPECT_NEAR(after[p].volume / before[p].volume, 1.0, 1e-12);
    for (std::size_t k = 0; k < tensor_components<dim>; ++k)
      EXPECT_NEAR(after[p].stress[k] / norm(any_stress), before[p].stress[k] / norm(any_stress),
                  5e-5);
  }
}

TEST(RigidRotation, keeps_stress_norm_and_volume_and_turns_the_stress) {
  const Vector<3> w{0.9, -1.3, 0.6};
  test::for_every_basis([&](basis::Kind kind) {
    turn_keeps_stress_and_volume<2>(kind, {{{0.0, -1.7}, {1.7, 0.0}}}, 1.7);
    turn_keeps_stress_and_volume<3>(kind,
                                    {{{0.0, -w[2], w[1]}, {w[2], 0.0, -w[0]}, {-w[1], w[0], 0.0}}},
                                    std::hypot(w[0], w[1], w[2]));
  });
}

// Bodies that collide ---------------------------------------------------------------------------

constexpr double disc_radius = 0.7, disc_distance = 0.95, disc_speed = 0.03;

/// Two discs about (-distance, 0) and (distance, 0) that approach each other; with a symmetry wall
/// at x = 0 one of them is left.
SimulationSetup<2> discs(bool half) {
  SimulationSetup<2> setup{.lines = {KnotLines::uniform(half ? 0.0 : -2.4, 2.4, half ? 24 : 48),
                                     KnotLines::uniform(-1.2, 1.2, 24)}};
  setup.communicator = test::world();
  setup.walls = test::walls_all<2>(Wall::free);
  if (half) setup.walls[0][0] = Wall::symmetry;
  setup.materials = {test::elastic()};
  setup.filling = {[](const Vector<2>& x) {
                     const double r = std::hypot(std::abs(x[0]) - disc_distance, x[1]);
                     return r < disc_radius ? std::optional(0) : std::nullopt;
                   },
                   [](const auto&) { return 2; }};
  return setup;
}

void start_discs(test::TimedSimulation<2>& simulation) {
  test::set_velocity<2>(simulation, [](const Vector<2>& x) {
    return Vector<2>{x[0] > 0.0 ? -disc_speed : disc_speed, 0.0};
  });
}

/// Of the motion about the common centre of mass.
double relative_energy(const test::TimedSimulation<2>& simulation) {
  const Vector<2> P = simulation.momentum();
  return simulation.kinetic_energy() - 0.5 * (P[0] * P[0] + P[1] * P[1]) / simulation.total_mass();
}

/// Between the facing ends of the discs.
double gap(test::TimedSimulation<2>& simulation) {
  double left = -1e9, right = 1e9;
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p) {
    const double x = view.position[0][p];
    if (x < view.displacement[0][p])
      left = std::max(left, x);
    else
      right = std::min(right, x);
  }
  return petsc::minimum(right) - petsc::maximum(left);
}

/// Sum of V sigma : C^-1 sigma / 2.
double strain_energy(test::TimedSimulation<2>& simulation) {
  const double E = test::soft.youngs_modulus, nu = test::soft.poisson_ratio;
  const auto view = simulation.particles().view();
  double energy = 0.0;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor s;
    for (int k = 0; k < 4; ++k) s[k] = view.stress[k][p];
    energy += 0.5 * view.volume[p] / E * ((1 + nu) * contract(s, s) - nu * trace(s) * trace(s));
  }
  return petsc::sum(energy);
}

/// Lets the discs run into each other with +-disc_speed about a common velocity, until they are as
/// far apart again as they were. Returns the share of the relative motion's energy that is left.
struct Rebound {
  double kinetic, lowest_kinetic, mechanical;
};
Rebound collide(test::TimedSimulation<2>& simulation, const Vector<2>& common) {
  test::set_velocity<2>(simulation, [&](const Vector<2>& x) {
    return Vector<2>{common[0] + (x[0] > 0.0 ? -disc_speed : disc_speed), common[1]};
  });
  const double mass = simulation.total_mass(), energy = relative_energy(simulation);
  const Vector<2> momentum = simulation.momentum();
  const double first_gap = gap(simulation);
  double lowest = energy;
  while (simulation.time() < 40.0 && (lowest == energy || gap(simulation) < first_gap)) {
    for (int k = 0; k < 20; ++k) simulation.advance();
    lowest = std::min(lowest, relative_energy(simulation));
  }
  EXPECT_GE(gap(simulation), first_gap);
  EXPECT_NEAR(simulation.total_mass() / mass, 1.0, 1e-13);
  for (int d : {0, 1})
    EXPECT_NEAR(simulation.momentum()[d], momentum[d], 1e-12 * mass * disc_speed);
  const double kinetic = relative_energy(simulation);
  return {kinetic / energy, lowest / energy, (kinetic + strain_energy(simulation)) / energy};
}

TEST(Collision, of_two_discs_keeps_mass_and_momentum_and_gives_the_energy_back) {
  test::TimedSimulation<2> simulation(discs(false));
  const Rebound rebound = collide(simulation, {0.0, 0.0});
  EXPECT_LT(rebound.lowest_kinetic, 0.2);
  EXPECT_GT(rebound.kinetic, 0.95);
}

/// Where the discs do not touch on a grid line, the common nodes hold them together for a while as
/// they part and leave stress in their surfaces: that energy is kept, but not as motion.
TEST(Collision, in_a_moving_frame_keeps_momentum_and_mechanical_energy) {
  test::TimedSimulation<2> simulation(discs(false));
  const Rebound rebound = collide(simulation, {-0.007, 0.009});
  EXPECT_LT(rebound.lowest_kinetic, 0.2);
  EXPECT_NEAR(rebound.mechanical, 1.0, 0.03);
}

/// Closes the gap of the discs quickly, then lets them swing.
constexpr double disc_dt = 2e-2;
constexpr int disc_steps = 1000;

void half_model_equals_the_full_one(basis::Kind kind) {
  auto full_setup = discs(false), half_setup = discs(true);
  full_setup.basis = half_setup.basis = kind;
  test::TimedSimulation<2> full(full_setup), half(half_setup);
  for (test::TimedSimulation<2>* simulation : {&full, &half}) {
    start_discs(*simulation);
    run_steps(*simulation, disc_steps, disc_dt);
  }
  EXPECT_GT(full.time(), 0.999 * disc_steps * disc_dt);  // dt was never cut
  auto by_start = [](const Snapshot<2>& a, const Snapshot<2>& b) {
    auto key = [](const Snapshot<2>& p) {
      return std::pair(std::llround(1e6 * p.start[1]), std::llround(1e6 * p.start[0]));
    };
    return key(a) < key(b);
  };
  auto right = test::snapshots(full.particles()), only = test::snapshots(half.particles());
  std::erase_if(right, [](const Snapshot<2>& p) { return p.start[0] < 0.0; });
  std::ranges::sort(right, by_start);
  std::ranges::sort(only, by_start);
  ASSERT_EQ(right.size(), only.size());
  double largest_stress = 0.0;
  for (const auto& p : right) largest_stress = std::max(largest_stress, std::abs(p.stress[0]));
  EXPECT_GT(largest_stress, 0.003 * test::soft.youngs_modulus);  // they did touch
  for (std::size_t p = 0; p < only.size(); ++p) {
    for (int d : {0, 1}) {
      EXPECT_NEAR(only[p].position[d], right[p].position[d], 1e-10 * disc_radius);
      EXPECT_NEAR(only[p].velocity[d], right[p].velocity[d], 1e-10 * disc_speed);
    }
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(only[p].stress[k], right[p].stress[k], 1e-10 * largest_stress);
  }
}

TEST(HalfModel, equals_the_full_one_over_1000_steps) {
  test::for_every_basis(half_model_equals_the_full_one);
}

// Ranks -----------------------------------------------------------------------------------------

std::vector<Snapshot<2>> discs_after(int steps) {
  test::TimedSimulation<2> simulation(discs(false));
  test::set_velocity<2>(simulation, [](const Vector<2>& x) {
    return x[0] > 0.0 ? Vector<2>{-2 * disc_speed, 0.03} : Vector<2>{3 * disc_speed, 0.02};
  });
  for (int k = 0; k < steps; ++k) simulation.advance();
  return test::snapshots(simulation.particles());
}

TEST(Ranks, give_the_same_motion_as_a_single_one) {
  const int steps = 300;
  const auto shared = discs_after(steps);
  const test::SerialWorld alone;
  const auto serial = discs_after(steps);
  ASSERT_EQ(shared.size(), serial.size());
  for (std::size_t p = 0; p < serial.size(); ++p)
    for (int d : {0, 1}) {
      EXPECT_EQ(shared[p].id, serial[p].id);
      EXPECT_NEAR(shared[p].position[d], serial[p].position[d], 1e-10 * disc_radius);
      EXPECT_NEAR(shared[p].velocity[d], serial[p].velocity[d], 1e-10 * disc_speed);
    }
  EXPECT_GT(serial[0].position[1] - serial[0].start[1], 0.2);  // some have changed their cells
}

TEST(Ranks, repeat_themselves_bit_for_bit) {
  const auto first = discs_after(300), second = discs_after(300);
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(Snapshot<2>)), 0);
}

// Failures --------------------------------------------------------------------------------------

constexpr std::int64_t victim = 95 * 4096 + 2;

/// Linear elasticity that gives up where its state says so.
class Brittle : public material::LinearElastic {
 public:
  Brittle() : LinearElastic(test::soft) {}
  std::span<const material::StateVariable> state_variables() const override {
    static const std::array<material::StateVariable, 1> fuse{{{"fuse", "0 while whole", "1", 0.0}}};
    return fuse;
  }
  void update_stress(const material::Batch& batch) const override {
    LinearElastic::update_stress(batch);
    for (std::size_t p = 0; p < batch.size; ++p)
      if (batch.state[0][p] != 0.0) batch.stress.component[1][p] = std::nan("");
  }
};

/// A block in the middle of a grid between free walls, and the victim alone below it.
SimulationSetup<2> block_and_victim() {
  auto setup = test::full_box<2>(equal_lines<2>(0.0, 2.6, 26), Wall::free);
  setup.materials = {std::make_shared<Brittle>()};
  setup.filling.material_at = [](const Vector<2>& x) {  // the victim is in cell (17, 3)
    const bool block = std::abs(x[0] - 1.3) < 0.5 && std::abs(x[1] - 1.6) < 0.5;
    const bool alone = std::hypot(x[0] - 1.725, x[1] - 0.375) < 0.01;
    return block || alone ? std::optional(0) : std::nullopt;
  };
  return setup;
}

/// Lets a change act on the victim; runs until all ranks fail with a message that has its id.
template <class Change>
void expect_failure_that_names_the_victim(const std::string& reason, const Change& change) {
  test::TimedSimulation<2> simulation(block_and_victim());
  int victims = 0;
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      if (view.id[p] == victim) ++victims, change(simulation.particles(), view, p);
  }
  EXPECT_EQ(petsc::sum(static_cast<long long>(victims)), 1);
  std::string message, details;
  try {
    for (int k = 0; k < 1000; ++k) simulation.advance();
  } catch (const NumericalFailure& failure) {
    message = failure.what();
    details = failure.details();
  }
  EXPECT_NE(message.find(fmt::format("particle {} ", victim)), std::string::npos) << message;
  EXPECT_NE(message.find(reason), std::string::npos) << message;
  const std::string step = fmt::format("\"last_good_step\":{},", simulation.steps());
  EXPECT_NE(details.find(step), std::string::npos) << details;
  EXPECT_NE(details.find(fmt::format("\"particle\":{},", victim)), std::string::npos) << details;
}

TEST(Failure, a_particle_thrown_out_of_a_free_wall_stops_all_ranks_by_name) {
  expect_failure_that_names_the_victim(
      "left the grid", [](const auto&, const auto& view, int p) { view.velocity[1][p] = -0.7; });
}

TEST(Failure, a_particle_that_outruns_its_waves_stops_all_ranks_before_it_is_lost) {
  expect_failure_that_names_the_victim(
      "faster than its waves",
      [](const auto&, const auto& view, int p) { view.velocity[0][p] = 1e3; });
}

TEST(Failure, a_stress_that_is_not_a_number_stops_all_ranks_by_name) {
  expect_failure_that_names_the_victim("not a number",
                                       [](const auto& particles, const auto& view, int p) {
                                         view[particles.state(0, "fuse")][p] = 1.0;
                                       });
}

// Order in time ---------------------------------------------------------------------------------

/// Share of the first mode in the stress of a bar between fixed ends that swings with small
/// amplitude. It starts strained and moving; the time steps grow from a tenth to nearly twice their
/// mean.
double swinging_bar(Scheme scheme, basis::Kind kind, int steps, double end_time) {
  auto setup = test::full_box<1>(equal_lines<1>(0.0, 1.3, 13), Wall::fixed);
  setup.basis = kind;
  setup.scheme = scheme;
  test::TimedSimulation<1> simulation(setup);
  const double k = std::numbers::pi / 1.3, amplitude = 1e-7;
  test::set_velocity<1>(simulation,
                        [&](const auto& x) { return Vector<1>{amplitude * std::sin(k * x[0])}; });
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      view.stress[0][p] =
          0.8 * amplitude * test::soft.youngs_modulus * std::cos(k * view.position[0][p]);
  }
  for (int n = 0; n < steps; ++n)
    run_steps(simulation, 1, end_time / steps * (0.1 + 1.8 * (n + 0.5) / steps));
  run_steps(simulation, 1, 1e-13);  // usf strains for an interval in the step after it
  EXPECT_NEAR(simulation.time(), end_time, 1e-12);
  double sum = 0.0;
  for (const Snapshot<1>& p : test::snapshots(simulation.particles()))
    sum += p.stress[0] * std::cos(k * p.start[0]);
  return sum / (amplitude * test::soft.youngs_modulus);
}

double order_in_time(Scheme scheme, basis::Kind kind, int steps) {
  const double coarse = swinging_bar(scheme, kind, steps, 1.3),
               middle = swinging_bar(scheme, kind, 2 * steps, 1.3),
               fine = swinging_bar(scheme, kind, 4 * steps, 1.3);
  EXPECT_LT(std::abs(middle - fine), 1e-2 * std::abs(fine));
  return std::log2((coarse - middle) / (middle - fine));
}

TEST(CentralDifference, is_of_second_order_with_a_halved_first_step_and_varying_steps) {
  test::for_every_basis([](basis::Kind kind) {
    EXPECT_NEAR(order_in_time(Scheme::musl, kind, 60), 2.0, 0.1);
    EXPECT_NEAR(order_in_time(Scheme::usf, kind, 60), 2.0, 0.1);
  });
}

/// What mapping an acceleration to particles and back takes from it strains the particles all the
/// same, times dt: this error is of first order.
TEST(CentralDifference, of_usl_is_of_first_order_and_ends_at_the_motion_of_musl) {
  test::for_every_basis([](basis::Kind kind) {
    EXPECT_NEAR(order_in_time(Scheme::usl, kind, 960), 1.0, 0.1);
    const double usl = swinging_bar(Scheme::usl, kind, 3840, 1.3);
    const double musl = swinging_bar(Scheme::musl, kind, 3840, 1.3);
    EXPECT_NEAR(usl / musl, 1.0, 1e-3);
  });
}

// FLIP with a rate ------------------------------------------------------------------------------

/// Rate at which the kinetic energy of a bar in its third mode decays, 1/s: from its mean over the
/// first and over the last second of five.
double decay_rate(basis::Kind kind, double courant, double flip_time) {
  auto setup = test::full_box<1>(equal_lines<1>(0.0, 1.3, 13), Wall::fixed);
  setup.basis = kind;
  setup.courant = courant;
  setup.flip_time = flip_time;
  test::TimedSimulation<1> simulation(setup);
  const double k = 3 * std::numbers::pi / 1.3;
  test::set_velocity<1>(simulation,
                        [&](const auto& x) { return Vector<1>{1e-6 * std::sin(k * x[0])}; });
  double first = 0.0, last = 0.0;
  while (simulation.time() < 5.0) {
    simulation.advance();
    const double share = simulation.kinetic_energy() * simulation.times.dt;
    if (simulation.time() < 1.0) first += share;
    if (simulation.time() > 4.0) last += share;
  }
  return std::log(first / last) / 4.0;
}

TEST(FlipTime, sets_a_decay_of_kinetic_energy_that_does_not_depend_on_the_step) {
  test::for_every_basis([](basis::Kind kind) {
    const double fine = decay_rate(kind, 0.05, 0.7), coarse = decay_rate(kind, 0.2, 0.7);
    EXPECT_GT(fine, 0.1);
    EXPECT_NEAR(coarse / fine, 1.0, 0.03);
  });
}

/// Neighbouring particles of a row between rollers move against each other, which adds up to no
/// momentum at any node. Returns the share of these velocities that is left after 1.1 s, and the
/// time that velocities have reached: half a step less.
struct Unseen {
  double smallest_share, largest_share, time;
};
Unseen unseen_pattern(Scheme scheme, basis::Kind kind, double flip_time) {
  auto setup = test::full_box<1>(equal_lines<1>(0.3, 2.9, 13), Wall::roller);
  setup.basis = kind;
  setup.scheme = scheme;
  setup.flip_time = flip_time;
  test::TimedSimulation<1> simulation(setup);
  const auto pattern = [](const Vector<1>& x) {
    return static_cast<int>((x[0] - 0.3) / 0.1) % 2 == 0 ? 0.013 : -0.013;
  };
  test::set_velocity<1>(simulation, [&](const auto& x) { return Vector<1>{pattern(x)}; });
  while (simulation.time() < 1.1) simulation.advance();
  Unseen unseen{1e9, -1e9, simulation.time() - 0.5 * simulation.times.dt};
  for (const Snapshot<1>& p : test::snapshots(simulation.particles())) {
    const double share = p.velocity[0] / pattern(p.start);
    unseen.smallest_share = std::min(unseen.smallest_share, share);
    unseen.largest_share = std::max(unseen.largest_share, share);
  }
  return unseen;
}

TEST(FlipTime, lets_velocities_that_the_grid_does_not_see_die_out_exponentially) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    const Unseen unseen = unseen_pattern(scheme, kind, 0.6);
    EXPECT_NEAR(unseen.smallest_share, std::exp(-unseen.time / 0.6), 1e-12);
    EXPECT_NEAR(unseen.largest_share, std::exp(-unseen.time / 0.6), 1e-12);
  });
}

TEST(FlipTime, of_infinity_keeps_velocities_that_the_grid_does_not_see) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    const Unseen unseen = unseen_pattern(scheme, kind, std::numeric_limits<double>::infinity());
    EXPECT_NEAR(unseen.smallest_share, 1.0, 1e-12);
    EXPECT_NEAR(unseen.largest_share, 1.0, 1e-12);
  });
}

std::vector<Snapshot<2>> shaken_block(const SimulationSetup<2>& setup) {
  test::TimedSimulation<2> simulation(setup);
  test::set_velocity<2>(simulation, [](const Vector<2>& x) {
    return Vector<2>{0.05 * std::sin(9 * x[1]), 0.03 * std::cos(11 * x[0])};
  });
  for (int k = 0; k < 60; ++k) simulation.advance();
  return test::snapshots(simulation.particles());
}

TEST(FlipTime, of_infinity_is_pure_flip_bit_for_bit) {
  for_every_scheme_and_basis([](Scheme scheme, basis::Kind kind) {
    auto setup = flying_block(kind);
    setup.scheme = scheme;
    setup.courant = courant_of(scheme);
    const auto pure = shaken_block(setup);
    setup.flip_time = std::numeric_limits<double>::infinity();
    EXPECT_EQ(shaken_block(setup), pure);
    setup.flip_time = 1e3;
    EXPECT_NE(shaken_block(setup), pure);
  });
}

}  // namespace
}  // namespace mpm::solver
