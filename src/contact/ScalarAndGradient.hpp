#pragma once

#include <vector>

#include "mpm/grid/NodalField.hpp"

namespace mpm::contact {

/// Components of what a PointDeposit fills.
template <int dim>
std::vector<grid::Component> scalar_and_gradient() {
  std::vector<grid::Component> components{{grid::Component::scalar}};
  for (int d = 0; d < dim; ++d) components.push_back({d});
  return components;
}

/// m^3 per unit of the dimensions left out.
template <int dim>
double cell_volume(const grid::Grid<dim>& grid, const std::array<int, dim>& node) {
  double volume = 1.0;
  for (int d = 0; d < dim; ++d)
    volume *= grid.nodes(d).cell_width[static_cast<std::size_t>(node[d])];
  return volume;
}

inline constexpr double smallest_mass_share = 1e-9;  ///< of a full cell

}  // namespace mpm::contact
