#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mpm/particles/Particles.hpp"

namespace mpm::particles {

/// Where the particles of a cell stand.
enum class Placement {
  midpoint,  ///< at the middles of equal parts of the cell
  gauss      ///< at Gauss points: no patch residual on graded cells; 1 to 3 per direction
};

/// What fills the grid at the start. All functions are the same on all ranks.
template <int dim>
struct Filling {
  /// Material at a point, or none.
  std::function<std::optional<int>(const Vector<dim>&)> material_at;
  /// Particles per direction in the cell around this centre.
  std::function<int(const Vector<dim>&)> per_direction;
  Placement placement = Placement::midpoint;
};

/// The particles of a cell, in a fixed order; ids are unique and independent of the ranks.
template <int dim>
std::vector<Seed<dim>> seeds_of_cell(const std::array<basis::KnotLines, dim>& lines,
                                     const std::array<int, dim>& cell, const Filling<dim>& filling);

}  // namespace mpm::particles
