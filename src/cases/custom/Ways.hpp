#pragma once

#include "Bodies.hpp"
#include "mpm/basis/KnotLines.hpp"
#include "mpm/grid/Walls.hpp"

namespace mpm::cases::custom {

/// That no body of constant velocity is on its way into a wall that holds soil, by the ends of the
/// stages. Throws BadInput.
template <int dim>
void check_ways(const CustomOptions& options, const std::vector<Body<dim>>& bodies,
                const std::array<basis::KnotLines, dim>& lines,
                const typename grid::Walls<dim>::Kinds& walls);

}  // namespace mpm::cases::custom
