#include <gtest/gtest.h>

#include <cmath>

#include "mpm/petsc/Session.hpp"
#include "support/Scenes.hpp"

namespace mpm::solver {
namespace {

constexpr double cell = 0.25;

/// A free block of soft elastic material away from all walls.
SimulationSetup<2> free_block(basis::Kind kind, Scheme scheme, Transfer transfer) {
  SimulationSetup<2> setup{.lines = test::equal_lines<2>(0.0, 16 * cell, 16)};
  setup.basis = kind;
  setup.scheme = scheme;
  setup.transfer = transfer;
  setup.walls = test::walls_all<2>(grid::Wall::free);
  setup.materials = {test::elastic()};
  setup.filling = {[](const Vector<2>& x) {
                     const bool inside =
                         x[0] > 5 * cell && x[0] < 10 * cell && x[1] > 6 * cell && x[1] < 10 * cell;
                     return inside ? std::optional(0) : std::nullopt;
                   },
                   [](const auto&) { return 2; }};
  return setup;
}

/// sum m (x cross v) and, of particles that carry a velocity gradient C, m (D_x C_yx - D_y C_xy).
double angular_momentum(const test::TimedSimulation<2>& simulation, double second_moment) {
  const auto view = simulation.particles().view();
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) {
    const Vector<2> x = view.position_of(p), v = view.velocity_of(p);
    double own = x[0] * v[1] - x[1] * v[0];
    if (view.velocity_gradient[0][0] != nullptr)
      own += second_moment * (view.velocity_gradient[1][0][p] - view.velocity_gradient[0][1][p]);
    sum += view.mass[p] * own;
  }
  return petsc::sum(sum);
}

/// Change of the angular momentum over some steps as a share of itself.
double change_of_angular_momentum(basis::Kind kind, Scheme scheme, Transfer transfer,
                                  double second_moment) {
  test::TimedSimulation<2> simulation(free_block(kind, scheme, transfer));
  test::set_velocity<2>(simulation, [](const Vector<2>& x) {
    return Vector<2>{-0.3 * x[1] + 0.05 * std::sin(9 * x[1]),
                     0.3 * x[0] + 0.04 * std::cos(7 * x[0])};
  });
  const double before = angular_momentum(simulation, second_moment);
  test::run_steps(simulation, 25, 1e-3);
  return std::abs(angular_momentum(simulation, second_moment) / before - 1.0);
}

TEST(Affine, angular_momentum_is_kept_where_pic_loses_it) {
  // sum N (x_I - x_p)^2 of quadratic and cubic splines.
  const double quadratic = cell * cell / 4, cubic = cell * cell / 3;
  for (const Scheme scheme : {Scheme::usl, Scheme::usf}) {
    EXPECT_LT(change_of_angular_momentum(basis::Kind::quadratic, scheme, Transfer::apic, quadratic),
              1e-12);
    EXPECT_LT(change_of_angular_momentum(basis::Kind::cubic, scheme, Transfer::apic, cubic), 1e-12);
    EXPECT_GT(change_of_angular_momentum(basis::Kind::cubic, scheme, Transfer::pic, cubic), 1e-3);
  }
}

TEST(Affine, linear_velocities_are_carried_with_their_gradient_by_every_basis_and_scheme) {
  const test::Gradient<2> L{{{-0.7, 1.1}, {0.4, 0.6}}};
  for (const Scheme scheme : {Scheme::musl, Scheme::usl, Scheme::usf})
    test::for_every_basis([&](basis::Kind kind) {
      test::TimedSimulation<2> simulation(free_block(kind, scheme, Transfer::apic));
      simulation.add_constraint(std::make_shared<test::PrescribedGradient<2>>(L));
      test::run_steps(simulation, 1, 1e-6);
      const auto view = simulation.particles().view();
      for (int p = 0; p < view.count; ++p)
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j) EXPECT_NEAR(view.velocity_gradient[i][j][p], L[i][j], 1e-11);
    });
}

TEST(Affine, only_affine_runs_have_columns_of_velocity_gradients) {
  const auto bytes = [](Transfer transfer) {
    return test::TimedSimulation<2>(free_block(basis::Kind::cubic, Scheme::musl, transfer))
        .particles()
        .bytes_per_particle();
  };
  EXPECT_EQ(bytes(Transfer::pic), bytes(Transfer::flip));
  EXPECT_EQ(bytes(Transfer::apic), bytes(Transfer::flip) + 4 * sizeof(double));
}

TEST(Affine, velocity_gradients_migrate_with_their_particles) {
  const auto after = [](double speed) {
    test::TimedSimulation<2> simulation(
        free_block(basis::Kind::cubic, Scheme::usl, Transfer::apic));
    const test::Gradient<2> L{{{0.0, -0.2}, {0.2, 0.0}}};
    test::set_velocity<2>(simulation, [&](const Vector<2>& x) {
      const Vector<2> v = test::linear_velocity<2>(L, x);
      return Vector<2>{v[0] + speed, v[1] + speed};
    });
    test::run_steps(simulation, 40, 0.01);
    const auto view = simulation.particles().view();
    double spin = 0.0;
    for (int p = 0; p < view.count; ++p)
      spin += view.velocity_gradient[1][0][p] - view.velocity_gradient[0][1][p];
    return petsc::sum(spin) / static_cast<double>(simulation.particles().global_count());
  };
  EXPECT_NEAR(after(1.5), after(0.0), 0.02 * after(0.0));  // over two and a half cells
}

}  // namespace
}  // namespace mpm::solver
