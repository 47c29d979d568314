#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mpm/partition/Ownership.hpp"

namespace mpm::partition {

/// Ranges of grid nodes: a Cartesian grid of processes, first direction fastest, each with a range
/// of nodes per direction.
template <int dim>
struct Layout {
  /// Per direction: first node of each process and, last, the number of nodes.
  std::array<std::vector<int>, dim> starts;

  int processes(int d) const { return static_cast<int>(starts[d].size()) - 1; }
};

/// What a layout must respect and what it balances.
template <int dim>
struct LayoutRequest {
  std::array<int, dim> nodes;
  int owner_offset;    ///< cell c belongs to the owner of node c + owner_offset
  int smallest_range;  ///< nodes that a process needs in every direction
  int ranks;
  CellWork<dim> work;
};

/// Ranges by prefix sums of the work, in the process shape of the smallest largest load. Local and
/// the same on all ranks. Throws BadInput, naming the largest number of ranks that works, if the
/// grid is too small.
template <int dim>
Layout<dim> balanced_layout(const LayoutRequest<dim>& request);

/// Ranges of equal numbers of nodes, in the same choice of process shapes.
template <int dim>
Layout<dim> uniform_layout(LayoutRequest<dim> request);

/// The cells that go with ranges of nodes, a block for each process.
template <int dim>
Ownership<dim> ownership_of(const Layout<dim>& layout, const std::array<int, dim>& cells,
                            int owner_offset);

}  // namespace mpm::partition
