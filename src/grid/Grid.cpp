#include "mpm/grid/Grid.hpp"

#include <algorithm>
#include <utility>

#include "mpm/petsc/Error.hpp"

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
void create_dmda(MPI_Comm communicator, const std::array<basis::NodeLine, dim>& nodes,
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
    MPM_PETSC(DMDACreate1d(communicator, none, counts[0], 1, width, lengths[0].data(), dm));
  else if constexpr (dim == 2)
    MPM_PETSC(DMDACreate2d(communicator, none, none, DMDA_STENCIL_BOX, counts[0], counts[1],
                           processes[0], processes[1], 1, width, lengths[0].data(),
                           lengths[1].data(), dm));
  else
    MPM_PETSC(DMDACreate3d(communicator, none, none, none, DMDA_STENCIL_BOX, counts[0], counts[1],
                           counts[2], processes[0], processes[1], processes[2], 1, width,
                           lengths[0].data(), lengths[1].data(), lengths[2].data(), dm));
  MPM_PETSC(DMSetUp(*dm));
}

/// Bits of a cell's mark.
constexpr unsigned char reachable = 1, owned = 2;

template <int dim>
Box<dim> box_of_ranges(const std::array<int, dim>& process, const partition::Layout<dim>& ranges) {
  Box<dim> box;
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<std::size_t>(process[d]);
    box.begin[d] = ranges.starts[d][k];
    box.end[d] = ranges.starts[d][k + 1];
  }
  return box;
}

template <int dim>
std::array<int, dim> cell_counts(const std::array<basis::NodeLine, dim>& nodes) {
  std::array<int, dim> cells;
  for (int d = 0; d < dim; ++d) cells[d] = nodes[d].lines.cells();
  return cells;
}

template <int dim>
Box<dim> united(const Box<dim>& a, const Box<dim>& b) {
  if (a.size() == 0) return b;
  Box<dim> box;
  for (int d = 0; d < dim; ++d) {
    box.begin[d] = std::min(a.begin[d], b.begin[d]);
    box.end[d] = std::max(a.end[d], b.end[d]);
  }
  return box;
}

/// The smallest box around the cells of every rank.
template <int dim>
std::vector<Box<dim>> boxes_around_cells(const partition::Ownership<dim>& ownership, int ranks) {
  std::vector<Box<dim>> boxes(static_cast<std::size_t>(ranks));
  std::array<int, dim> counts;
  for (int d = 0; d < dim; ++d) counts[d] = ownership.blocks(d);
  partition::for_each_cell<dim>(counts, [&](std::size_t k, const std::array<int, dim>& block) {
    Box<dim> cells;
    for (int d = 0; d < dim; ++d) {
      cells.begin[d] = ownership.starts(d)[static_cast<std::size_t>(block[d])];
      cells.end[d] = ownership.starts(d)[static_cast<std::size_t>(block[d]) + 1];
    }
    Box<dim>& box = boxes[static_cast<std::size_t>(ownership.ranks()[k])];
    if (cells.size() > 0) box = united(box, cells);
  });
  return boxes;
}

/// The box with one more cell to all sides within the grid, unless it is empty.
template <int dim>
Box<dim> with_drift(Box<dim> cells, const Box<dim>& all) {
  if (cells.size() == 0) return cells;
  for (int d = 0; d < dim; ++d) --cells.begin[d], ++cells.end[d];
  return intersection(cells, all);
}

/// Marks what lies up to `ahead` places after or `back` places before a mark, along d.
template <int dim>
void spread(Marks& marks, const Box<dim>& box, int d, int back, int ahead) {
  const Marks before = marks;
  box.for_each([&](int k, const std::array<int, dim>& index) {
    if (before[static_cast<std::size_t>(k)] == 0) return;
    const int last = std::min(ahead, box.end[d] - 1 - index[d]);
    for (int j = -std::min(back, index[d] - box.begin[d]); j <= last; ++j)
      marks[static_cast<std::size_t>(k + j * box.stride(d))] = 1;
  });
}

/// A box, or those of its cells that have the bit; `frame` has the marks.
template <int dim>
CellSet<dim> marked_cells(const Box<dim>& box, const Box<dim>& frame, const Marks& marks,
                          unsigned char bit) {
  const CellSet<dim> set(box, frame, marks, bit);
  int count = 0;
  set.for_each([&](const auto&) { ++count; });
  return count == box.size() ? CellSet<dim>(box) : set;
}

/// The nodes of a box of local arrays for which holds(position, node).
template <int dim, class Predicate>
std::vector<Run<dim>> runs_where(const Box<dim>& box, const Predicate& holds) {
  std::vector<Run<dim>> runs;
  bool continues = false;
  box.for_each([&](int local, const std::array<int, dim>& node) {
    const bool taken = holds(local, node);
    if (taken && continues && node[0] != box.begin[0])
      ++runs.back().count;
    else if (taken)
      runs.push_back({local, 1, node});
    continues = taken;
  });
  return runs;
}

/// Whether rows of nodes that a particle touches one after another, `stride` apart in y and z, have
/// addresses that agree but for multiples of 4096 bytes. A processor takes a load from such an
/// address for one of what it has just stored, and waits.
template <int dim>
bool has_aliases(const Box<dim>& box) {
  constexpr int near = 64, page = 4096, rows = 3;
  for (int j = dim > 1 ? -rows : 0; j <= (dim > 1 ? rows : 0); ++j)
    for (int k = dim > 2 ? -rows : 0; k <= (dim > 2 ? rows : 0); ++k) {
      std::ptrdiff_t nodes = 0;
      if constexpr (dim > 1) nodes += j * box.stride(1);
      if constexpr (dim > 2) nodes += k * box.stride(2);
      const auto bytes = std::abs(nodes) * static_cast<std::ptrdiff_t>(sizeof(double));
      const auto rest = bytes % page;
      if (bytes > page - near && std::min(rest, page - rest) < near) return true;
    }
  return false;
}

/// A box of local arrays, longer by nodes that nobody uses where its rows would be aliases.
template <int dim>
Box<dim> without_aliases(Box<dim> box) {
  constexpr int most = 32;  // boxes up to 400 by 400 rows need 21 at most
  for (int added = 0; added < most && box.size() > 0 && has_aliases(box); ++added) ++box.end[0];
  return box;
}

/// What lies in a box.
template <int dim>
std::vector<Run<dim>> cut(const std::vector<Run<dim>>& runs, const Box<dim>& box) {
  std::vector<Run<dim>> inside;
  for (Run<dim> run : runs) {
    const int skipped = std::max(0, box.begin[0] - run.node[0]);
    run.count = std::min(run.count, box.end[0] - run.node[0]) - skipped;
    run.first += skipped;
    run.node[0] += skipped;
    if (run.count > 0 && box.contains(run.node)) inside.push_back(run);
  }
  return inside;
}

}  // namespace

template <int dim>
Grid<dim>::Grid(const petsc::Communicator& communicator,
                const std::array<basis::NodeLine, dim>& nodes, const partition::Layout<dim>& ranges)
    : m_communicator(communicator),
      m_nodes(nodes),
      m_rank(communicator.rank()),
      m_ranks(communicator.size()),
      m_recorded(box_of_ranges<dim>(coordinates_of<dim>(m_rank, ranges), ranges)),
      m_ownership(
          partition::ownership_of<dim>(ranges, cell_counts<dim>(nodes), nodes[0].owner_offset)),
      m_owned_cells({}),
      m_reachable_cells({}),
      m_active_cells({}),
      m_active_box(all_cells()) {
  create_dmda<dim>(communicator, nodes, ranges, stencil_width(nodes[0]), m_dm.address());
  set_ownership(m_ownership);
}

template <int dim>
void Grid<dim>::set_ownership(partition::Ownership<dim> ownership) {
  m_ownership = std::move(ownership);
  ++m_ownership_version;
  find_boxes();
  mark_cells();
  find_runs();
  find_end_layers();
  find_active_runs();
}

template <int dim>
void Grid<dim>::find_boxes() {
  const std::vector<Box<dim>> owned_boxes = boxes_around_cells(m_ownership, m_ranks);
  m_ghosted_of.clear();
  for (const Box<dim>& cells : owned_boxes) {
    Box<dim> box = with_drift(cells, all_cells());
    for (int d = 0; d < dim && box.size() > 0; ++d) box.end[d] += m_nodes[d].support - 1;
    m_ghosted_of.push_back(without_aliases(box));
  }
  m_ghosted = ghosted_nodes_of(m_rank);
  m_own_box = owned_boxes[static_cast<std::size_t>(m_rank)];
  m_local_cells = with_drift(m_own_box, all_cells());
}

template <int dim>
void Grid<dim>::mark_cells() {
  const auto size = static_cast<std::size_t>(m_local_cells.size());
  Marks own(size, 0);
  m_local_cells.for_each([&](int k, const Index& cell) {
    own[static_cast<std::size_t>(k)] = rank_of_cell(cell) == m_rank ? 1 : 0;
  });
  m_cell_marks = own;
  for (int d = 0; d < dim; ++d) spread(m_cell_marks, m_local_cells, d, 1, 1);
  for (std::size_t k = 0; k < size; ++k)
    if (own[k] != 0) m_cell_marks[k] = reachable | owned;
  m_owned_cells = marked_cells(m_own_box, m_local_cells, m_cell_marks, owned);
  m_reachable_cells = marked_cells(m_local_cells, m_local_cells, m_cell_marks, reachable);
}

template <int dim>
void Grid<dim>::find_runs() {
  Marks touched(static_cast<std::size_t>(local_size()), 0);
  m_reachable_cells.for_each([&](const Index& cell) {  // cell c touches the nodes from c on
    touched[static_cast<std::size_t>(local_index(cell))] = 1;
  });
  for (int d = 0; d < dim; ++d) spread(touched, m_ghosted, d, 0, m_nodes[d].support - 1);
  m_local_runs = runs_where(m_ghosted, [&](int local, const Index&) {
    return touched[static_cast<std::size_t>(local)] != 0;
  });
  const Box<dim> nodes = all_nodes();
  m_owned_runs = runs_where(m_ghosted, [&](int, const Index& node) {
    return nodes.contains(node) && rank_of_node(node) == m_rank;
  });
}

template <int dim>
void Grid<dim>::find_end_layers() {
  for (int d = 0; d < dim; ++d)
    for (int side : {0, 1}) {
      auto& layers = m_end_layers[d][static_cast<std::size_t>(side)];
      layers.assign(static_cast<std::size_t>(m_nodes[d].support), {});
      for_each_owned_node([&](int local, const Index& node) {
        const int a = side == 0 ? node[d] : m_nodes[d].count() - 1 - node[d];
        if (a < m_nodes[d].support) layers[static_cast<std::size_t>(a)].push_back(local);
      });
    }
}

template <int dim>
void Grid<dim>::set_active_cells(const Box<dim>& cells) {
  if (cells == m_active_box) return;
  m_active_box = cells;
  find_active_runs();
}

template <int dim>
void Grid<dim>::find_active_runs() {
  Box<dim> nodes = m_active_box;  // cell c reaches the nodes c to c + support - 1
  for (int d = 0; d < dim; ++d) nodes.end[d] += m_nodes[d].support - 1;
  m_active_cells = marked_cells(intersection(m_active_box, m_local_cells), m_local_cells,
                                m_cell_marks, reachable);
  m_active_runs = cut(m_owned_runs, nodes);
  m_active_local_runs = cut(m_local_runs, nodes);
  ++m_active_version;
}

template <int dim>
int Grid<dim>::rank_of_node(const Index& node) const {
  Index cell;
  for (int d = 0; d < dim; ++d)
    cell[d] = std::clamp(node[d] - m_nodes[d].owner_offset, 0, m_nodes[d].lines.cells() - 1);
  return rank_of_cell(cell);
}

/// The owner's local numbering follows from the ownership, so that no indices are sent around.
template <int dim>
void Grid<dim>::connect_record() const {
  std::vector<PetscSFNode> roots;
  m_recorded.for_each([&](int, const Index& node) {
    const int owner = rank_of_node(node);
    roots.push_back({owner, ghosted_nodes_of(owner).index_of(node)});
  });
  m_record.reset();
  MPM_PETSC(PetscSFCreate(m_communicator, m_record.address()));
  MPM_PETSC(PetscSFSetGraph(m_record, local_size(), static_cast<PetscInt>(roots.size()), nullptr,
                            PETSC_COPY_VALUES, roots.data(), PETSC_COPY_VALUES));
  MPM_PETSC(PetscSFSetUp(m_record));
  m_record_version = m_ownership_version;
}

template <int dim>
std::vector<double> Grid<dim>::to_record(const double* local) const {
  if (m_record_version != m_ownership_version) connect_record();
  std::vector<double> record(static_cast<std::size_t>(m_recorded.size()));
  MPM_PETSC(PetscSFBcastBegin(m_record, MPIU_SCALAR, local, record.data(), MPI_REPLACE));
  MPM_PETSC(PetscSFBcastEnd(m_record, MPIU_SCALAR, local, record.data(), MPI_REPLACE));
  return record;
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
