#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../bench/ElasticBlock.hpp"

// The solver and the yardstick of tools/bench, which share no code, take the same steps.

namespace mpm {
namespace {

constexpr std::int64_t ids_per_cell = 4096;  // see seeds_of_cell

/// Place of a particle of the solver in the list of the yardstick.
template <int dim>
std::size_t plain_index(const bench::Block& block, std::int64_t id) {
  const int all = block.cells + 2 * block.margin;
  std::int64_t cell = id / ids_per_cell;
  int index = 0, particles = 1, stride = 1;
  for (int d = 0; d < dim; ++d, cell /= all) {
    index += stride * (static_cast<int>(cell % all) - block.margin);
    stride *= block.cells;
    particles *= block.particles_per_direction;
  }
  return static_cast<std::size_t>(index * particles + static_cast<int>(id % ids_per_cell));
}

/// Largest differences on this rank, as shares of cell, speed, largest stress and volume.
struct Differences {
  double position = 0.0, velocity = 0.0, stress = 0.0, volume = 0.0;
};

constexpr int symmetric_index[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

template <int dim>
Differences compare(const bench::Block& block, const solver::Simulation<dim>& simulation,
                    const bench::PlainBody<dim>& plain) {
  Differences largest;
  double stress = 0.0;
  const auto raise = [](double& to, double a, double b) { to = std::max(to, std::abs(a - b)); };
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p) {
    const auto& expected = plain.particles()[plain_index<dim>(block, view.id[p])];
    for (int i = 0; i < dim; ++i) {
      raise(largest.position, view.position[i][p], expected.x[i]);
      raise(largest.position, view.displacement[i][p], expected.displacement[i]);
      raise(largest.velocity, view.velocity[i][p], expected.v[i]);
      for (int j = 0; j < dim; ++j) {
        raise(largest.stress, view.stress[symmetric_index[i][j]][p], expected.stress[i][j]);
        stress = std::max(stress, std::abs(expected.stress[i][j]));
      }
    }
    if constexpr (dim == 2) raise(largest.stress, view.stress[2][p], expected.stress_out_of_plane);
    raise(largest.volume, view.volume[p] / expected.V, 1.0);
  }
  largest.position /= block.cell;
  largest.velocity /= block.speed;
  largest.stress /= stress;
  return largest;
}

template <int dim>
void expect_equal_steps(const bench::Block& block, int steps) {
  const auto simulation = bench::make_elastic_block<dim>(block);
  bench::PlainBody<dim> plain(block);
  for (int k = 0; k < steps; ++k) {
    const solver::StepTimes times = simulation->advance(0.0, simulation->plan());
    plain.step(times.momentum_dt(), times.dt);
    const Differences largest = compare<dim>(block, *simulation, plain);
    constexpr double tolerance = 1e-12;
    EXPECT_LT(largest.position, tolerance) << "step " << k + 1;
    EXPECT_LT(largest.velocity, tolerance) << "step " << k + 1;
    EXPECT_LT(largest.stress, tolerance) << "step " << k + 1;
    EXPECT_LT(largest.volume, tolerance) << "step " << k + 1;
  }
}

TEST(PlainStep, takes_the_steps_of_the_solver_in_two_dimensions) {
  expect_equal_steps<2>({.cells = 17, .speed = 0.7, .gravity = 9.81}, 15);
}

TEST(PlainStep, takes_the_steps_of_the_solver_in_three_dimensions) {
  expect_equal_steps<3>({.cells = 8, .speed = 0.7, .gravity = 9.81}, 15);
}

TEST(PlainStep, conserves_momentum) {
  const bench::Block block{.cells = 9};
  bench::PlainBody<2> plain(block);
  const auto start = plain.momentum();
  const double scale = plain.mass() * block.speed;
  for (int k = 0; k < 100; ++k) plain.step(block.time_step(), block.time_step());
  for (std::size_t d = 0; d < 2; ++d) EXPECT_NEAR(plain.momentum()[d], start[d], 1e-13 * scale);
}

}  // namespace
}  // namespace mpm
