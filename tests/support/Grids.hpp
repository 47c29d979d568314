#pragma once

#include <array>
#include <utility>

#include "mpm/grid/Grid.hpp"
#include "support/World.hpp"

namespace mpm::test {

using Spline = basis::BSpline<3>;

/// Cells of uneven widths from 0.4 m on.
inline basis::KnotLines graded_lines(int cells) {
  std::vector<double> positions{0.4};
  for (int k = 0; k < cells; ++k) positions.push_back(positions.back() + 0.3 + 0.04 * (k % 5));
  return basis::KnotLines(std::move(positions));
}

template <int dim>
std::array<Spline, dim> splines(const std::array<basis::KnotLines, dim>& lines,
                                basis::EndTreatment ends = basis::EndTreatment::mirror) {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<Spline, dim>{Spline(lines[d], ends)...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

template <int dim>
std::array<basis::NodeLine, dim> node_lines(const std::array<Spline, dim>& splines) {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<basis::NodeLine, dim>{splines[d].nodes()...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

/// All ranks along the last direction but one of two, which is split first; the first process of a
/// direction has as little as it may, the last one the most.
template <int dim>
partition::Layout<dim> uneven_layout(const std::array<basis::NodeLine, dim>& nodes) {
  std::array<int, dim> processes;
  processes.fill(1);
  const int ranks = world_size();
  if (dim > 1 && ranks % 2 == 0) processes[0] = 2;
  processes[dim - 1] = ranks / (dim > 1 ? processes[0] : 1);
  partition::Layout<dim> layout;
  for (int d = 0; d < dim; ++d) {
    const int smallest = grid::Grid<dim>::stencil_width(nodes[d]);
    for (int k = 0; k < processes[d]; ++k) layout.starts[d].push_back(k * smallest);
    layout.starts[d].push_back(nodes[d].count());
  }
  return layout;
}

/// Blocks of two cells per direction, the last of them larger where a cell is left over, dealt out
/// to the ranks so that neighbours are often another's.
template <int dim>
partition::Ownership<dim> scattered_blocks(const std::array<basis::NodeLine, dim>& nodes) {
  std::array<std::vector<int>, dim> starts;
  std::size_t count = 1;
  for (int d = 0; d < dim; ++d) {
    const int cells = nodes[d].lines.cells();
    for (int cell = 0; cell == 0 || cell + 2 <= cells; cell += 2) starts[d].push_back(cell);
    starts[d].push_back(cells);
    count *= starts[d].size() - 1;
  }
  std::vector<int> ranks;
  for (std::size_t k = 0; k < count; ++k)
    ranks.push_back(static_cast<int>((3 * k + k * k / 4) % static_cast<std::size_t>(world_size())));
  return {std::move(starts), std::move(ranks)};
}

/// Who owns the cells of a grid.
enum class Owners { uneven_ranges, scattered_blocks };

template <int dim>
void give_cells_to(Owners owners, grid::Grid<dim>& grid,
                   const std::array<basis::NodeLine, dim>& nodes) {
  if (owners == Owners::scattered_blocks) grid.set_ownership(scattered_blocks<dim>(nodes));
}

}  // namespace mpm::test
