#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "PlainStep.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::bench {

template <int dim>
solver::SimulationSetup<dim> setup_with_equal_lines(const basis::KnotLines& line) {
  return [&]<int... d>(std::integer_sequence<int, d...>) {
    return solver::SimulationSetup<dim>{.lines = {((void)d, line)...}};
  }
  (std::make_integer_sequence<int, dim>{});
}

/// The block of the yardstick as the solver sees it. Collective.
template <int dim>
std::unique_ptr<solver::Simulation<dim>> make_elastic_block(const Block& block) {
  const auto line = basis::KnotLines::uniform(-block.margin * block.cell,
                                              (block.cells + block.margin) * block.cell,
                                              block.cells + 2 * block.margin);
  auto setup = setup_with_equal_lines<dim>(line);
  for (auto& direction : setup.walls) direction = {grid::Wall::free, grid::Wall::free};
  setup.materials = {std::make_shared<material::LinearElastic>(
      material::LinearElasticParameters{.youngs_modulus = block.youngs_modulus,
                                        .poisson_ratio = block.poisson_ratio,
                                        .density = block.density})};
  const double side = block.cells * block.cell;
  setup.filling = {[side](const Vector<dim>& x) -> std::optional<int> {
                     for (double c : x)
                       if (!(c > 0.0 && c < side)) return std::nullopt;
                     return 0;
                   },
                   [n = block.particles_per_direction](const auto&) { return n; }};
  setup.particles_per_cell = block.particles_per_direction;
  setup.gravity[dim - 1] = -block.gravity;
  setup.courant = block.courant;
  auto simulation = std::make_unique<solver::Simulation<dim>>(setup);
  const auto view = simulation->particles().view();
  for (int p = 0; p < view.count; ++p) {
    const auto v = block.velocity<dim>(view.position_of(p));
    for (int d = 0; d < dim; ++d) view.velocity[d][p] = v[static_cast<std::size_t>(d)];
  }
  return simulation;
}

}  // namespace mpm::bench
