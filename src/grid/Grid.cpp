#include "mpm/grid/Grid.hpp"

#include <algorithm>

#include "mpm/petsc/Error.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::grid {
namespace {

template <int dim>
std::array<int, dim> coordinates_of(int rank, const partition::Layout<dim>& layout) {
  std::array<int, dim> process;
  for (int d = 0; d < dim; ++d) {
    process[d] = rank % layout.processes(d);
    rank /= layout.processes(d);
  }
  return process;
}

std::vector<PetscInt> range_lengths(const std::vector<int>& starts) {
  std::vector<PetscInt> lengths;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) lengths.push_back(starts[k + 1] - starts[k]);
  return lengths;
}

template <int dim>
void create_dmda(const std::array<basis::NodeLine, dim>& nodes,
                 const partition::Layout<dim>& layout, int width, DM* dm) {
  std::array<std::vector<PetscInt>, 3> lengths;
  std::array<PetscInt, 3> counts{1, 1, 1}, processes{1, 1, 1};
  for (int d = 0; d < dim; ++d) {
    lengths[d] = range_lengths(layout.starts[d]);
    counts[d] = nodes[d].count();
    processes[d] = layout.processes(d);
  }
  const DMBoundaryType none = DM_BOUNDARY_NONE;
  if constexpr (dim == 1)
    MPM_PETSC(DMDACreate1d(PETSC_COMM_WORLD, none, counts[0], 1, width, lengths[0].data(), dm));
  else if constexpr (dim == 2)
    MPM_PETSC(DMDACreate2d(PETSC_COMM_WORLD, none, none, DMDA_STENCIL_BOX, counts[0], counts[1],
                           processes[0], processes[1], 1, width, lengths[0].data(),
                           lengths[1].data(), dm));
  else
    MPM_PETSC(DMDACreate3d(PETSC_COMM_WORLD, none, none, none, DMDA_STENCIL_BOX, counts[0],
                           counts[1], counts[2], processes[0], processes[1], processes[2], 1, width,
                           lengths[0].data(), lengths[1].data(), lengths[2].data(), dm));
  MPM_PETSC(DMSetUp(*dm));
}

/// Cells of a process, widened by `drift` cells and cut at the ends of the grid.
template <int dim>
Box<dim> cells_of(const Box<dim>& owned, const std::array<basis::NodeLine, dim>& nodes, int drift) {
  Box<dim> cells;
  for (int d = 0; d < dim; ++d) {
    const int first = owned.begin[d] - nodes[d].owner_offset;
    const int last = owned.end[d] - nodes[d].owner_offset;
    cells.begin[d] = std::clamp(first - drift, 0, nodes[d].lines.cells());
    cells.end[d] = std::clamp(last + drift, 0, nodes[d].lines.cells());
  }
  return cells;
}

}  // namespace

template <int dim>
Grid<dim>::Grid(const std::array<basis::NodeLine, dim>& nodes, const partition::Layout<dim>& layout)
    : m_nodes(nodes), m_layout(layout) {
  create_dmda<dim>(nodes, layout, stencil_width(nodes[0]), m_dm.address());
  const Index process = coordinates_of<dim>(petsc::world_rank(), layout);
  m_owned = owned_box_of(process);
  m_ghosted = ghosted_box_of(process);
  m_owned_cells = cells_of<dim>(m_owned, nodes, 0);
  m_reachable_cells = cells_of<dim>(m_owned, nodes, 1);
  m_owned_runs = runs_of(m_owned);
  set_active_cells(all_cells());
}

template <int dim>
std::vector<Run<dim>> Grid<dim>::runs_of(const Box<dim>& box) const {
  std::vector<Run<dim>> runs;
  if (box.size() <= 0) return runs;
  for (Index node = box.begin;;) {
    runs.push_back({local_index(node), box.extent(0), node});
    int d = 1;
    while (d < dim && ++node[d] == box.end[d]) node[d] = box.begin[d], ++d;
    if (d >= dim) return runs;
  }
}

template <int dim>
void Grid<dim>::set_active_cells(const Box<dim>& cells) {
  Box<dim> nodes = cells;  // cell c reaches the nodes c to c + support - 1
  for (int d = 0; d < dim; ++d) nodes.end[d] += m_nodes[d].support - 1;
  m_active_cells = intersection(cells, m_reachable_cells);
  const Box<dim> owned = intersection(nodes, m_owned);
  nodes = intersection(nodes, m_ghosted);
  if (nodes == m_active_nodes) return;
  m_active_nodes = nodes;
  m_active_runs = runs_of(owned);
  m_active_local_runs = runs_of(nodes);
  ++m_active_version;
}

template <int dim>
Box<dim> Grid<dim>::owned_box_of(const Index& process) const {
  Box<dim> box;
  for (int d = 0; d < dim; ++d) {
    box.begin[d] = m_layout.starts[d][static_cast<std::size_t>(process[d])];
    box.end[d] = m_layout.starts[d][static_cast<std::size_t>(process[d]) + 1];
  }
  return box;
}

template <int dim>
Box<dim> Grid<dim>::ghosted_box_of(const Index& process) const {
  Box<dim> box = owned_box_of(process);
  for (int d = 0; d < dim; ++d) {
    box.begin[d] = std::max(0, box.begin[d] - stencil_width(m_nodes[d]));
    box.end[d] = std::min(m_nodes[d].count(), box.end[d] + stencil_width(m_nodes[d]));
  }
  return box;
}

template <int dim>
int Grid<dim>::rank_of_cell(const Index& cell) const {
  Index process;
  for (int d = 0; d < dim; ++d)
    process[d] = m_layout.process_of(d, cell[d] + m_nodes[d].owner_offset);
  return m_layout.rank_of(process);
}

template <int dim>
long long Grid<dim>::global_cells() const {
  long long product = 1;
  for (int d = 0; d < dim; ++d) product *= m_nodes[d].lines.cells();
  return product;
}

template class Grid<1>;
template class Grid<2>;
template class Grid<3>;

}  // namespace mpm::grid
