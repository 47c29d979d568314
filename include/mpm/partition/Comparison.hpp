#pragma once

#include "mpm/partition/Layout.hpp"

namespace mpm::partition {

/// Largest over mean number of particles of a rank, for ways to share out the same particles.
struct Imbalances {
  double uniform_ranges;   ///< ranges of equal numbers of nodes
  double balanced_ranges;  ///< see balanced_layout
  double metis_blocks;
};

/// What these would be on request.ranks ranks; request.work are the numbers of particles. Needs
/// none of these ranks. Throws BadInput if the grid is too small for them.
template <int dim>
Imbalances compare(const LayoutRequest<dim>& request);

}  // namespace mpm::partition
