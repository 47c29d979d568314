#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace mpm::partition {

/// Who owns which grid nodes: a Cartesian grid of processes, first direction fastest, each with a
/// range of nodes per direction.
template <int dim>
struct Layout {
  /// Per direction: first node of each process and, last, the number of nodes.
  std::array<std::vector<int>, dim> starts;

  int processes(int d) const { return static_cast<int>(starts[d].size()) - 1; }
  int process_of(int d, int node) const {
    const auto after = std::upper_bound(starts[d].begin(), starts[d].end(), node);
    return static_cast<int>(after - starts[d].begin()) - 1;
  }
  int rank_of(const std::array<int, dim>& process) const {
    int rank = 0;
    for (int d = dim - 1; d >= 0; --d) rank = rank * processes(d) + process[d];
    return rank;
  }
};

/// What a layout must respect and what it balances.
template <int dim>
struct LayoutRequest {
  std::array<int, dim> nodes;
  std::array<int, dim> cells;
  int owner_offset;    ///< cell c belongs to the owner of node c + owner_offset
  int smallest_range;  ///< nodes that a process needs in every direction
  int ranks;
  /// Work in a cell, e.g. its number of particles; the same function on all ranks.
  std::function<double(const std::array<int, dim>&)> weight;
};

/// Ranges by prefix sums of the weights, in the process shape of the smallest largest load.
/// Local and the same on all ranks. Throws BadInput, naming the largest number of ranks that
/// works, if the grid is too small.
template <int dim>
Layout<dim> balanced_layout(const LayoutRequest<dim>& request);

/// Largest load of a rank over the mean load.
template <int dim>
double imbalance(const LayoutRequest<dim>& request, const Layout<dim>& layout);

}  // namespace mpm::partition
