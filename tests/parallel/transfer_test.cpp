#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "mpm/basis/Bases.hpp"
#include "support/Grids.hpp"
#include "support/PlainTransfer.hpp"
#include "support/Scenes.hpp"

namespace mpm::transfer {
namespace {

constexpr double round_off = 1e-13;  // of the largest value of a column

template <int dim>
std::array<basis::KnotLines, dim> lines() {
  if constexpr (dim == 1) return {test::graded_lines(23)};
  if constexpr (dim == 2) return {test::graded_lines(12), basis::KnotLines::uniform(-1.3, 2.9, 15)};
  if constexpr (dim == 3)
    return {test::graded_lines(9), basis::KnotLines::uniform(-0.7, 1.5, 7), test::graded_lines(12)};
}

template <int dim, class Basis>
std::array<Basis, dim> bases() {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<Basis, dim>{basis::make_basis<Basis>(
        lines<dim>()[d], {.ends = basis::EndTreatment::mirror, .particles_per_cell = 2})...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

template <int dim, class Basis>
std::array<basis::NodeLine, dim> nodes_of(const std::array<Basis, dim>& bases) {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<basis::NodeLine, dim>{bases[d].nodes()...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

/// Particles anywhere in the cells that are this rank's, in no order, a number that no pack
/// divides, with a state of their own; and nodal values.
template <int dim, class Basis>
struct World {
  World() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    std::vector<particles::Seed<dim>> seeds;
    std::int64_t id = 0;
    grid.owned_cells().for_each([&](const std::array<int, dim>& cell) {
      for (int k = 0; k < 3; ++k) {
        particles::Seed<dim> seed{.id = id++, .position = {}, .volume = 0.2 + 0.1 * k};
        for (int d = 0; d < dim; ++d)
          seed.position[d] = lines<dim>()[d].line(cell[d]) +
                             0.5 * (1.0 + uniform(random)) * lines<dim>()[d].width(cell[d]);
        seeds.push_back(seed);
      }
    });
    if (seeds.size() % 4 == 0) seeds.pop_back();
    particles.add(seeds);
    const auto view = particles.view();
    for (int p = 0; p < view.count; ++p) {
      const int q = std::uniform_int_distribution(0, p)(random);
      for (int d = 0; d < dim; ++d) {
        std::swap(view.position[d][p], view.position[d][q]);
        view.velocity[d][p] = 0.7 * uniform(random);
      }
      for (int k = 0; k < tensor_components<dim>; ++k) view.stress[k][p] = 40.0 * uniform(random);
    }
    for (grid::NodalField<dim>* field : {&sums, &rates, &remapped})
      for (int c = 0; c < field->components(); ++c)
        for (int I = 0; I < grid.local_size(); ++I) field->values(c)[I] = 1.3 * uniform(random);
  }

  std::array<Basis, dim> basis = bases<dim, Basis>();
  grid::Grid<dim> grid{test::world(), nodes_of<dim, Basis>(basis),
                       test::uneven_layout<dim>(nodes_of<dim, Basis>(basis))};
  particles::Particles<dim> particles{grid, {test::elastic()}};
  grid::NodalField<dim> sums{grid, MassMomentumForce<dim>::components()};
  grid::NodalField<dim> rates{grid, VelocityAcceleration<dim>::components()};
  grid::NodalField<dim> remapped{grid, NodalVector<dim>::components()};
};

void expect_same(const double* a, const double* b, int count) {
  double scale = 0.0;
  for (int i = 0; i < count; ++i) scale = std::max(scale, std::abs(b[i]));
  for (int i = 0; i < count; ++i) ASSERT_NEAR(a[i], b[i], round_off * scale) << i;
}

template <int dim>
void expect_same(grid::NodalField<dim>& a, grid::NodalField<dim>& b, int count) {
  for (int c = 0; c < a.components(); ++c) expect_same(a.values(c), b.values(c), count);
}

template <int dim>
void expect_same(const std::array<double*, dim>& a, const std::array<double*, dim>& b, int count) {
  for (int d = 0; d < dim; ++d) expect_same(a[d], b[d], count);
}

/// Both worlds begin the same; one takes the loops of the program, the other plain ones.
template <int dim, class Basis>
void compare_sweeps(double flip_share) {
  World<dim, Basis> fast, plain;
  const auto f = fast.particles.view(), g = plain.particles.view();
  const int nodes = fast.grid.local_size();
  const test::PlainTransfer<dim, Basis> reference(plain.grid, plain.basis);
  const Stencil<dim, Basis> stencil(fast.grid, fast.basis);
  BodyForce<dim> body_force;
  body_force.uniform.fill(-3.1);

  ParticleBodyForce<dim> particle_force;
  particle_force.find(body_force, f);
  deposit_mass_momentum_force<dim, Basis>(f, stencil, particle_force,
                                          MassMomentumForce<dim>(fast.sums));
  reference.deposit(g, body_force.uniform, MassMomentumForce<dim>(plain.sums));
  expect_same<dim>(fast.sums, plain.sums, nodes);

  constexpr double dt = 0.013;
  update_velocities_and_deposit_momentum<dim, Basis>(f, stencil, dt, flip_share,
                                                     VelocityAcceleration<dim>(fast.rates),
                                                     NodalVector<dim>(fast.remapped));
  reference.update_velocities_and_deposit(g, dt, flip_share, VelocityAcceleration<dim>(plain.rates),
                                          NodalVector<dim>(plain.remapped));
  expect_same<dim>(fast.remapped, plain.remapped, nodes);
  expect_same<dim>(f.velocity, g.velocity, f.count);

  Increments increments;
  gather_increments_and_move<dim, Basis>(f, {0, f.count}, stencil, {.strain = dt, .move = dt},
                                         VelocityAcceleration<dim>(fast.rates),
                                         NodalVector<dim>(fast.remapped), fast.grid, increments);
  const auto L = reference.strain_and_move(g, dt, VelocityAcceleration<dim>(plain.rates),
                                           NodalVector<dim>(plain.remapped));
  expect_same<dim>(f.position, g.position, f.count);
  expect_same<dim>(f.displacement, g.displacement, f.count);
  constexpr std::array<std::array<int, 2>, 3> spins{{{0, 1}, {1, 2}, {0, 2}}};
  for (std::size_t p = 0; p < L.size(); ++p) {
    for (int i = 0; i < dim; ++i)
      for (int j = i; j < dim; ++j) {
        const int k = test::PlainTransfer<dim, Basis>::component(i, j);
        ASSERT_NEAR(increments.strain[k][p], 0.5 * (L[p][i][j] + L[p][j][i]) * dt, 1e-12);
      }
    for (int k = 0; k < (dim == 3 ? 3 : dim - 1); ++k)
      ASSERT_NEAR(increments.spin[k][p],
                  0.5 * (L[p][spins[k][0]][spins[k][1]] - L[p][spins[k][1]][spins[k][0]]) * dt,
                  1e-12);
  }
}

template <int dim>
void compare_sweeps_of_every_basis() {
  test::for_every_basis([](basis::Kind kind) {
    basis::with_basis(kind, []<class Basis>() {
      compare_sweeps<dim, Basis>(1.0);
      compare_sweeps<dim, Basis>(0.83);
    });
  });
}

TEST(Transfer, sweeps_agree_with_plain_loops_to_round_off) {
  compare_sweeps_of_every_basis<1>();
  compare_sweeps_of_every_basis<2>();
  compare_sweeps_of_every_basis<3>();
}

SymmetricTensor turned(const SymmetricTensor& s, const std::array<Vector<3>, 3>& Q) {
  const auto full = [](const SymmetricTensor& t, int i, int j) {
    return t[i == j ? i : i + j == 1 ? 3 : i + j == 3 ? 4 : 5];
  };
  constexpr std::array<std::array<int, 2>, 6> pairs{
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};
  SymmetricTensor result;
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        result[k] += Q[pairs[k][0]][i] * full(s, i, j) * Q[pairs[k][1]][j];
  return result;
}

/// (1 - W/2)^-1 (1 + W/2) by its series, for small W.
std::array<Vector<3>, 3> cayley(const std::array<Vector<3>, 3>& W) {
  std::array<Vector<3>, 3> Q{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, power = Q;
  for (int n = 1; n < 40; ++n) {
    std::array<Vector<3>, 3> next{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k) next[i][j] += 0.5 * power[i][k] * W[k][j];
    power = next;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) Q[i][j] += 2.0 * power[i][j];
  }
  return Q;
}

template <int dim>
void check_rotation() {
  World<dim, basis::BSpline<2>> world;
  const auto view = world.particles.view();
  Increments increments;
  increments.cover({0, view.count}, dim);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.2, 0.2);
  std::vector<SymmetricTensor> expected;
  std::vector<double> volume, strain;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor e, s;
    std::array<double, 3> w{};
    for (int k = 0; k < dim; ++k) increments.strain[k][p] = e[k] = uniform(random);
    for (int k = 3; k < tensor_components<dim>; ++k)
      increments.strain[k][p] = e[k] = uniform(random);
    for (int k = 0; k < (dim == 3 ? 3 : 1); ++k) increments.spin[k][p] = w[k] = uniform(random);
    for (int k = 0; k < tensor_components<dim>; ++k) s[k] = view.stress[k][p];
    expected.push_back(turned(s, cayley({{{0, w[0], w[2]}, {-w[0], 0, w[1]}, {-w[2], -w[1], 0}}})));
    volume.push_back(view.volume[p] * std::exp(trace(e)));
    strain.push_back(view.deviatoric_strain[p] + std::sqrt(2.0 / 3.0) * norm(deviator(e)));
  }
  rotate_and_expand<dim>(view, increments);
  for (int p = 0; p < view.count; ++p) {
    for (int k = 0; k < tensor_components<dim>; ++k)
      ASSERT_NEAR(view.stress[k][p], expected[p][k], 1e-13 * 40.0);
    ASSERT_NEAR(view.volume[p], volume[p], 1e-15);
    ASSERT_NEAR(view.deviatoric_strain[p], strain[p], 1e-15);
  }
}

TEST(Transfer, stresses_turn_by_the_cayley_form_of_the_spin_and_volumes_grow_by_its_exponential) {
  check_rotation<2>();
  check_rotation<3>();
}

}  // namespace
}  // namespace mpm::transfer
