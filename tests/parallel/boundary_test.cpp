#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Session.hpp"
#include "support/Scenes.hpp"

namespace mpm::particles {
namespace {

using grid::Wall;
using solver::Simulation;
using solver::SimulationSetup;
using test::Gradient;

template <int dim>
using Pieces = std::vector<SurfacePiece<dim>>;

/// A boundary particle at one moment; its pressure is its name.
template <int dim>
struct Patch {
  double pressure;
  Vector<dim> anchor, offset, area;
};

/// The boundary particles of all ranks by pressure, on every rank. Collective.
template <int dim>
std::vector<Patch<dim>> patches(const BoundaryParticles<dim>& boundary) {
  std::vector<Patch<dim>> mine;
  {
    const auto view = boundary.view();
    for (int b = 0; b < view.count; ++b)
      mine.push_back({view.pressure[b], view.anchor_of(b), view.offset_of(b), view.area_of(b)});
  }
  auto all = test::of_all_ranks(mine);
  std::ranges::sort(all, {}, &Patch<dim>::pressure);
  return all;
}

template <int dim>
SimulationSetup<dim> free_box(basis::Kind kind, int per_direction = 1) {
  auto setup =
      test::full_box<dim>(test::equal_lines<dim>(-0.7, 3.2, 13), Wall::free, per_direction);
  setup.basis = kind;
  return setup;
}

// Force on the grid -----------------------------------------------------------------------------

/// Sum of the nodal forces, and of their moments x_I f_J - x_J f_I, of the load alone.
template <int dim>
struct Resultant {
  Vector<dim> force{};
  Gradient<dim> moment{};
};

template <int dim>
Resultant<dim> resultant(test::TimedSimulation<dim>& simulation) {
  test::run_steps(simulation, 1, 1e-13);
  const grid::NodalField<dim>& sums = simulation.step().nodal_sums();
  Resultant<dim> total;
  simulation.grid().for_each_owned_node([&](int I, const auto& node) {
    const Vector<dim> x = simulation.grid().position(node);
    for (int i = 0; i < dim; ++i) {
      total.force[i] += sums.values(1 + dim + i)[I];
      for (int j = 0; j < dim; ++j)
        total.moment[i][j] +=
            x[i] * sums.values(1 + dim + j)[I] - x[j] * sums.values(1 + dim + i)[I];
    }
  });
  for (double& component : total.force) component = petsc::sum(component);
  for (auto& row : total.moment)
    for (double& component : row) component = petsc::sum(component);
  return total;
}

/// Anchors all over the grid, with offsets of up to a cell to any side.
template <int dim>
Pieces<dim> scattered(int count) {
  std::mt19937 random(20);
  std::uniform_real_distribution<double> inside(-0.69, 3.19), beside(-0.3, 0.3), area(-0.2, 0.2);
  Pieces<dim> pieces(static_cast<std::size_t>(count));
  for (SurfacePiece<dim>& piece : pieces) {
    for (double& component : piece.anchor) component = inside(random);
    for (double& component : piece.offset) component = beside(random);
    for (double& component : piece.area) component = area(random);
    piece.pressure = 3e4 * inside(random);
  }
  return pieces;
}

template <int dim>
void load_is_minus_pressure_times_area_at_its_place(basis::Kind kind) {
  test::TimedSimulation<dim> simulation(free_box<dim>(kind));
  const Pieces<dim> pieces = scattered<dim>(57);
  simulation.boundary().add(pieces);
  const Resultant<dim> load = resultant(simulation);
  for (int i = 0; i < dim; ++i) {
    double force = 0.0;
    for (const auto& piece : pieces) force -= piece.pressure * piece.area[i];
    EXPECT_NEAR(load.force[i], force, 1e-12 * 3e4);
    for (int j = 0; j < dim; ++j) {
      double moment = 0.0;
      for (const auto& [anchor, offset, area, p] : pieces)
        moment -= p * ((anchor[i] + offset[i]) * area[j] - (anchor[j] + offset[j]) * area[i]);
      EXPECT_NEAR(load.moment[i][j], moment, 1e-11 * 3e4);
    }
  }
}

TEST(SurfaceLoad, is_minus_pressure_times_area_at_the_place_of_the_surface) {
  test::for_every_basis([](basis::Kind kind) {
    load_is_minus_pressure_times_area_at_its_place<1>(kind);
    load_is_minus_pressure_times_area_at_its_place<2>(kind);
    load_is_minus_pressure_times_area_at_its_place<3>(kind);
  });
}

/// A side of a polygon or a triangle, from its corners; anchored on the middle of the body.
SurfacePiece<2> side(const Vector<2>& a, const Vector<2>& b, const Vector<2>& middle, double p) {
  return {middle,
          {0.5 * (a[0] + b[0]) - middle[0], 0.5 * (a[1] + b[1]) - middle[1]},
          {b[1] - a[1], a[0] - b[0]},
          p};
}
SurfacePiece<3> side(const std::array<Vector<3>, 3>& x, const Vector<3>& middle, double p) {
  SurfacePiece<3> piece{middle, {}, {}, p};
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    piece.offset[i] = (x[0][i] + x[1][i] + x[2][i]) / 3 - middle[i];
    piece.area[i] = 0.5 * ((x[1][j] - x[0][j]) * (x[2][k] - x[0][k]) -
                           (x[1][k] - x[0][k]) * (x[2][j] - x[0][j]));
  }
  return piece;
}

Pieces<2> polygon() {
  const std::array<Vector<2>, 4> corners{{{1.1, 0.7}, {1.43, 0.78}, {1.61, 1.05}, {1.02, 1.31}}};
  Pieces<2> sides;
  for (std::size_t k = 0; k < 4; ++k)
    sides.push_back(side(corners[k], corners[(k + 1) % 4], {1.3, 1.0}, 4.1e4));
  return sides;
}
Pieces<3> tetrahedron() {
  const Vector<3> a{1.1, 0.9, 1.0}, b{1.6, 1.0, 1.1}, c{1.2, 1.5, 0.95}, d{1.25, 1.1, 1.62};
  const Vector<3> middle{1.3, 1.1, 1.2};
  return {side({a, c, b}, middle, 4.1e4), side({a, b, d}, middle, 4.1e4),
          side({b, c, d}, middle, 4.1e4), side({c, a, d}, middle, 4.1e4)};
}

template <int dim>
void closed_surface_has_no_resultant(basis::Kind kind, const Pieces<dim>& pieces) {
  test::TimedSimulation<dim> simulation(free_box<dim>(kind));
  simulation.boundary().add(pieces);
  const Resultant<dim> load = resultant(simulation);
  double largest = 0.0;
  simulation.grid().for_each_owned_node([&](int I, const auto&) {
    largest = std::max(largest, std::abs(simulation.step().nodal_sums().values(1 + dim)[I]));
  });
  EXPECT_GT(petsc::maximum(largest), 50.0);  // N: it does press
  for (int i = 0; i < dim; ++i) {
    EXPECT_NEAR(load.force[i], 0.0, 1e-13 * 4.1e4);
    for (int j = 0; j < dim; ++j) EXPECT_NEAR(load.moment[i][j], 0.0, 1e-13 * 4.1e4);
  }
}

TEST(SurfaceLoad, of_a_closed_surface_neither_pushes_nor_turns) {
  test::for_every_basis([](basis::Kind kind) {
    closed_surface_has_no_resultant<2>(kind, polygon());
    closed_surface_has_no_resultant<3>(kind, tetrahedron());
  });
}

// Equilibrium -----------------------------------------------------------------------------------

/// A piece of surface before every particle on the upper sides of a box from the origin on.
template <int dim>
Pieces<dim> upper_sides(double length, int particles, double pressure) {
  const double spacing = length / particles;
  Pieces<dim> pieces;
  for (int normal = 0; normal < dim; ++normal)
    for (int k = 0; k < std::pow(particles, dim - 1); ++k) {
      SurfacePiece<dim> piece{{}, {}, {}, pressure};
      for (int d = 0, rest = k; d < dim; ++d) {
        if (d == normal) continue;
        piece.anchor[d] = (rest % particles + 0.5) * spacing;
        rest /= particles;
      }
      piece.anchor[normal] = length - 0.5 * spacing;
      piece.offset[normal] = 0.5 * spacing;
      piece.area[normal] = std::pow(spacing, dim - 1);
      pieces.push_back(piece);
    }
  return pieces;
}

/// Largest nodal force in a box between symmetry walls, under the stress -p and pressed with p on
/// its other sides, which stand at `length` on a grid of cells of 0.3 m; a share of p times face.
template <int dim>
double pressed_box(basis::Kind kind, int cells, double length, int per_direction) {
  const double p = 2.7e4, width = 0.3;
  auto setup = test::full_box<dim>(test::equal_lines<dim>(0.0, cells * width, cells), Wall::free,
                                   per_direction);
  setup.basis = kind;
  for (auto& direction : setup.walls) direction[0] = Wall::symmetry;
  setup.filling.material_at = [length](const Vector<dim>& x) {
    return *std::ranges::max_element(x) < length ? std::optional(0) : std::nullopt;
  };
  test::TimedSimulation<dim> simulation(setup);
  test::set_stress(simulation, {{-p, -p, -p, 0.0, 0.0, 0.0}});
  const auto particles = static_cast<int>(std::lround(length / width * per_direction));
  simulation.boundary().add(upper_sides<dim>(length, particles, p));
  test::run_steps(simulation, 1, 1e-13);
  double largest = 0.0;
  simulation.grid().for_each_owned_node([&](int I, const auto&) {
    for (int d = 0; d < dim; ++d)
      largest = std::max(largest, std::abs(simulation.step().nodal_sums().values(1 + dim + d)[I]));
  });
  return petsc::maximum(largest) / (p * std::pow(width, dim - 1));
}

TEST(PressedBox, of_a_single_linear_cell_is_in_equilibrium) {
  const test::SerialWorld alone;  // one cell has too few nodes for many ranks
  for (int n : {1, 2, 3}) {
    EXPECT_LT(pressed_box<1>(basis::Kind::linear, 1, 0.3, n), 1e-14);
    EXPECT_LT(pressed_box<2>(basis::Kind::linear, 1, 0.3, n), 1e-14);
    EXPECT_LT(pressed_box<3>(basis::Kind::linear, 1, 0.3, n), 1e-14);
  }
}

/// Two particles per cell; the sides stand on a grid line, then half-way between two.
TEST(PressedBox, is_in_equilibrium_with_linear_and_quadratic_splines) {
  for (const basis::Kind kind : {basis::Kind::linear, basis::Kind::quadratic})
    for (double length : {1.8, 1.95}) {
      EXPECT_LT(pressed_box<1>(kind, 13, length, 2), 1e-13);
      EXPECT_LT(pressed_box<2>(kind, 11, length, 2), 1e-13);
      EXPECT_LT(pressed_box<3>(kind, 9, length, 2), 1e-13);
    }
}

/// The midpoint rule leaves h^3 N'''/(24 n^2) of every cell in the body. The signs of cubic splines
/// are 1, -3, 3, -1: where the surface cuts a support on a grid line, 1, -2, 1 are left.
TEST(PressedBox, keeps_the_quadrature_error_of_cut_cubic_splines) {
  for (int n : {1, 2, 3})
    EXPECT_NEAR(pressed_box<1>(basis::Kind::cubic, 13, 1.8, n), 2.0 / (24 * n * n), 1e-13);
  EXPECT_NEAR(pressed_box<2>(basis::Kind::cubic, 11, 1.8, 2), 2.0 / (24 * 4), 1e-3);
}

// Motion ----------------------------------------------------------------------------------------

template <int dim>
Gradient<dim> product(const Gradient<dim>& A, const Gradient<dim>& B) {
  Gradient<dim> C{};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j)
      for (int k = 0; k < dim; ++k) C[i][j] += A[i][k] * B[k][j];
  return C;
}

/// exp(L t), the deformation after a time t under a constant velocity gradient.
template <int dim>
Gradient<dim> deformation(const Gradient<dim>& L, double t) {
  Gradient<dim> term{}, sum{};
  for (int i = 0; i < dim; ++i) term[i][i] = sum[i][i] = 1.0;
  for (int n = 1; n < 30; ++n) {
    term = product<dim>(term, L);
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) sum[i][j] += term[i][j] *= t / n;
  }
  return sum;
}

/// J F^-T, the matrix of cofactors.
Gradient<2> cofactors(const Gradient<2>& F) {
  return {{{F[1][1], -F[1][0]}, {-F[0][1], F[0][0]}}};
}
Gradient<3> cofactors(const Gradient<3>& F) {
  Gradient<3> C{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      C[i][j] = F[a][c] * F[b][d] - F[a][d] * F[b][c];
    }
  return C;
}

struct Errors {
  double offset = 0.0, area = 0.0;
};

/// Largest differences of offsets and area vectors from F r and J F^-T a after 0.4 s, as shares.
template <int dim>
Errors following(basis::Kind kind, const Gradient<dim>& L, int steps) {
  auto setup = test::full_box<dim>(test::equal_lines<dim>(-1.95, 1.95, 13), Wall::free);
  setup.basis = kind;
  setup.filling.material_at = [](const Vector<dim>& x) {
    return std::ranges::all_of(x, [](double c) { return std::abs(c) < 0.5; }) ? std::optional(0)
                                                                              : std::nullopt;
  };
  setup.materials = {test::elastic({.youngs_modulus = 1.0, .poisson_ratio = 0.1, .density = 900})};
  test::TimedSimulation<dim> simulation(setup);
  simulation.add_constraint(std::make_shared<test::PrescribedGradient<dim>>(L));
  Pieces<dim> pieces = scattered<dim>(11);
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    for (double& component : pieces[k].anchor)  // on a particle
      component = 0.15 * std::floor(2 * std::sin(9 * component)) + 0.075;
    pieces[k].pressure = static_cast<double>(k);
  }
  simulation.boundary().add(pieces);
  const double time = 0.4;
  test::run_steps(simulation, steps, time / steps);
  EXPECT_NEAR(simulation.time(), time, 1e-12);
  const Gradient<dim> F = deformation<dim>(L, time);
  Errors errors;
  for (const Patch<dim>& patch : patches(simulation.boundary())) {
    const auto& piece = pieces[static_cast<std::size_t>(patch.pressure)];
    const Vector<dim> r = test::linear_velocity<dim>(F, piece.offset);
    const Vector<dim> a = test::linear_velocity<dim>(cofactors(F), piece.area);
    for (int d = 0; d < dim; ++d) {
      errors.offset = std::max(errors.offset, std::abs(patch.offset[d] - r[d]) / 0.3);
      errors.area = std::max(errors.area, std::abs(patch.area[d] - a[d]) / 0.2);
    }
  }
  return errors;
}

template <int dim>
void follows_to_second_order(basis::Kind kind, const Gradient<dim>& L) {
  const Errors coarse = following<dim>(kind, L, 20), fine = following<dim>(kind, L, 40);
  EXPECT_LT(fine.offset, 2e-4);
  EXPECT_LT(fine.area, 2e-4);
  EXPECT_NEAR(std::log2(coarse.offset / fine.offset), 2.0, 0.1);
  EXPECT_NEAR(std::log2(coarse.area / fine.area), 2.0, 0.1);
}

TEST(SurfaceMotion, follows_turn_stretch_and_any_gradient_to_second_order) {
  const Gradient<2> turn{{{0.0, -1.3}, {1.3, 0.0}}}, stretch{{{0.8, 0.0}, {0.0, -0.5}}};
  const Gradient<3> any{{{0.4, -0.3, 0.2}, {0.9, -0.6, -0.5}, {-0.4, 0.35, 0.7}}};
  test::for_every_basis([&](basis::Kind kind) {
    follows_to_second_order<2>(kind, turn);
    follows_to_second_order<2>(kind, stretch);
    follows_to_second_order<3>(kind, any);
  });
}

TEST(SurfaceMotion, follows_simple_shear_exactly) {
  const Gradient<2> plane{{{0.0, 1.7}, {0.0, 0.0}}};
  const Gradient<3> space{{{0.0, 0.0, 0.0}, {0.0, 0.0, -1.1}, {0.0, 0.0, 0.0}}};
  test::for_every_basis([&](basis::Kind kind) {
    for (const Errors& errors : {following<2>(kind, plane, 20), following<3>(kind, space, 20)}) {
      EXPECT_LT(errors.offset, 1e-12);
      EXPECT_LT(errors.area, 1e-12);
    }
  });
}

/// A block that is pressed all round, with a different pressure everywhere, in a wide sky.
SimulationSetup<2> flying_block(basis::Kind kind) {
  SimulationSetup<2> setup{.lines = test::equal_lines<2>(-0.4, 4.4, 24)};
  setup.communicator = test::world();
  setup.basis = kind;
  setup.walls = test::walls_all<2>(Wall::free);
  setup.materials = {test::elastic()};
  setup.filling = {[](const Vector<2>& x) {
                     const bool inside = x[0] > 0 && x[0] < 1.2 && x[1] > 0 && x[1] < 1;
                     return inside ? std::optional(0) : std::nullopt;
                   },
                   [](const auto&) { return 2; }};
  return setup;
}

Pieces<2> all_round() {
  Pieces<2> pieces;
  const double d = 0.1;  // between particles
  for (int k = 0; k < 10; ++k)
    for (double sign : {-1.0, 1.0})
      pieces.push_back({{sign < 0 ? 0.05 : 1.15, (k + 0.5) * d}, {sign * d / 2, 0}, {sign * d, 0}});
  for (int k = 0; k < 12; ++k)
    for (double sign : {-1.0, 1.0})
      pieces.push_back({{(k + 0.5) * d, sign < 0 ? 0.05 : 0.95}, {0, sign * d / 2}, {0, sign * d}});
  for (std::size_t k = 0; k < pieces.size(); ++k)
    pieces[k].pressure = 200.0 + static_cast<double>(k);
  return pieces;
}

struct Flight {
  std::vector<Patch<2>> patches;
  std::vector<test::Snapshot<2>> particles;
  bool came_or_went;  ///< the number of boundary particles of this rank has changed
};

Flight flight(basis::Kind kind, double seconds) {
  test::TimedSimulation<2> simulation(flying_block(kind));
  test::set_velocity<2>(simulation, [](const auto&) { return Vector<2>{1.1, 0.9}; });
  simulation.boundary().add(all_round());
  const int first = simulation.boundary().view().count;
  while (simulation.time() < seconds) simulation.advance();
  {
    const auto view = simulation.boundary().view();
    for (int b = 0; b < view.count; ++b)
      EXPECT_TRUE(simulation.grid().reachable_cells().contains(
          simulation.grid().cell_of(view.anchor_of(b))));
  }
  return {patches(simulation.boundary()), test::snapshots(simulation.particles()),
          simulation.boundary().view().count != first};
}

TEST(SurfaceMotion, keeps_anchors_on_their_particles_while_the_body_deforms) {
  test::for_every_basis([](basis::Kind kind) {
    const Flight end = flight(kind, 2.0);
    const Pieces<2> pieces = all_round();
    double deformation = 0.0;
    for (std::size_t b = 0; b < pieces.size(); ++b) {
      const auto particle = std::ranges::find_if(end.particles, [&](const auto& p) {
        return std::hypot(p.start[0] - pieces[b].anchor[0], p.start[1] - pieces[b].anchor[1]) <
               1e-9;
      });
      ASSERT_NE(particle, end.particles.end());
      for (int d : {0, 1}) EXPECT_NEAR(end.patches[b].anchor[d], particle->position[d], 1e-12);
      deformation = std::max(deformation, std::abs(particle->volume / 0.01 - 1.0));
    }
    EXPECT_GT(deformation, 0.1);
  });
}

TEST(SurfaceMotion, crosses_ranks_without_loss_and_as_on_a_single_one) {
  test::for_every_basis([](basis::Kind kind) {
    const Flight shared = flight(kind, 2.0);
    const bool somewhere = petsc::maximum(shared.came_or_went ? 1.0 : 0.0) > 0.0;
    EXPECT_EQ(somewhere, test::world_size() > 1);
    const test::SerialWorld alone;
    const Flight serial = flight(kind, 2.0);
    ASSERT_EQ(shared.patches.size(), all_round().size());
    for (std::size_t b = 0; b < serial.patches.size(); ++b) {
      const Patch<2>&one = serial.patches[b], &other = shared.patches[b];
      EXPECT_EQ(other.pressure, one.pressure);
      for (int d : {0, 1}) {
        EXPECT_NEAR(other.anchor[d], one.anchor[d], 1e-10);
        EXPECT_NEAR(other.offset[d], one.offset[d], 1e-10 * 0.05);
        EXPECT_NEAR(other.area[d], one.area[d], 1e-10 * 0.1);
      }
    }
    EXPECT_GT(serial.patches[0].anchor[0], 1.8);
  });
}

// Making and losing -----------------------------------------------------------------------------

TEST(BoundaryParticles, of_a_second_surface_join_those_of_the_first) {
  test::TimedSimulation<2> simulation(flying_block(basis::Kind::cubic));
  EXPECT_TRUE(simulation.boundary().is_empty());
  Pieces<2> first = all_round(), second(first.end() - 5, first.end());
  first.resize(first.size() - 5);
  simulation.boundary().add(first);
  simulation.boundary().add(second);
  EXPECT_EQ(simulation.boundary().global_count(), 44);
  const auto found = patches(simulation.boundary());
  const Pieces<2> given = all_round();
  ASSERT_EQ(found.size(), given.size());
  for (std::size_t b = 0; b < found.size(); ++b) {
    EXPECT_EQ(found[b].pressure, given[b].pressure);
    EXPECT_EQ(found[b].anchor, given[b].anchor);
    EXPECT_EQ(found[b].offset, given[b].offset);
    EXPECT_EQ(found[b].area, given[b].area);
  }
}

TEST(BoundaryParticles, anchored_outside_the_grid_are_refused_on_all_ranks) {
  for (const Vector<2>& outside :
       {Vector<2>{-0.41, 0.3}, Vector<2>{0.2, 4.41}, Vector<2>{0.2, std::nan("")}}) {
    test::TimedSimulation<2> simulation(flying_block(basis::Kind::linear));
    Pieces<2> pieces = all_round();
    pieces[7].anchor = outside;
    EXPECT_THROW(simulation.boundary().add(pieces), BadInput);
  }
}

TEST(BoundaryParticles, that_leave_the_grid_stop_all_ranks) {
  test::TimedSimulation<2> simulation(flying_block(basis::Kind::quadratic));
  simulation.boundary().add(all_round());
  {
    const auto view = simulation.boundary().view();
    for (int b = 0; b < view.count; ++b)
      if (view.pressure[b] == 213.0) view.anchor[1][b] = -0.9;
  }
  EXPECT_THROW(simulation.boundary().migrate(), NumericalFailure);
}

}  // namespace
}  // namespace mpm::particles
