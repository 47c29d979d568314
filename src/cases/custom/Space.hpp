#pragma once

#include "CustomOptions.hpp"
#include "Lists.hpp"
#include "mpm/basis/KnotLines.hpp"
#include "mpm/grid/Walls.hpp"

namespace mpm::cases::custom {

/// The grid lines that the options ask for. Throws BadInput where they make no sense together or
/// make more than 1e9 cells.
template <int dim>
std::array<basis::KnotLines, dim> lines_of(const CustomOptions& options);

/// Throws BadInput for a wrong word or number of walls.
template <int dim>
typename grid::Walls<dim>::Kinds walls_of(const CustomOptions& options);

}  // namespace mpm::cases::custom
