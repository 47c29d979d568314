#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "mpm/material/LinearElastic.hpp"
#include "mpm/solver/Simulation.hpp"
#include "support/World.hpp"

namespace mpm::test {

inline constexpr material::LinearElasticParameters soft{
    .youngs_modulus = 2.5e3, .poisson_ratio = 0.28, .density = 1300.0};

inline std::shared_ptr<const material::Material> elastic(
    const material::LinearElasticParameters& parameters = soft) {
  return std::make_shared<material::LinearElastic>(parameters);
}

/// The same kind of wall at both ends of every direction.
template <int dim>
typename grid::Walls<dim>::Kinds walls_all(grid::Wall wall) {
  typename grid::Walls<dim>::Kinds kinds;
  for (auto& direction : kinds) direction = {wall, wall};
  return kinds;
}

/// A grid that is full of soft elastic material.
template <int dim>
solver::SimulationSetup<dim> full_box(const std::array<basis::KnotLines, dim>& lines,
                                      grid::Wall wall, int per_direction = 2) {
  solver::SimulationSetup<dim> setup{.lines = lines};
  setup.walls = walls_all<dim>(wall);
  setup.materials = {elastic()};
  setup.filling = {[](const auto&) { return 0; },
                   [per_direction](const auto&) { return per_direction; }};
  return setup;
}

/// Sets the velocity of every particle to a function of its position. Local.
template <int dim>
void set_velocity(solver::Simulation<dim>& simulation,
                  const std::function<Vector<dim>(const Vector<dim>&)>& velocity) {
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p) {
    const Vector<dim> v = velocity(view.position_of(p));
    for (int d = 0; d < dim; ++d) view.velocity[d][p] = v[d];
  }
}

template <int dim>
void set_stress(solver::Simulation<dim>& simulation, const SymmetricTensor& stress) {
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    for (int k = 0; k < tensor_components<dim>; ++k) view.stress[k][p] = stress[k];
}

}  // namespace mpm::test
