#pragma once

#include <petscdmda.h>

#include <array>
#include <vector>

#include "mpm/basis/BSpline.hpp"
#include "mpm/core/Tensor.hpp"
#include "mpm/grid/Box.hpp"
#include "mpm/partition/Layout.hpp"
#include "mpm/petsc/Communicator.hpp"
#include "mpm/petsc/Handle.hpp"

namespace mpm::grid {

/// The background grid: a PETSc DMDA of spline nodes, and which nodes and cells are this rank's.
/// Cells belong to ranks by blocks, see partition::Ownership, and a node goes with the cell
/// `owner_offset` nodes before it. A rank's local arrays cover the smallest box of nodes that its
/// cells and those one cell of drift away reach, first direction fastest. The DMDA keeps the ranges
/// that it was made with, whoever owns the cells: it is the grid of global vectors and of output.
template <int dim>
class Grid {
 public:
  using Index = std::array<int, dim>;

  /// Cells are owned as the ranges of nodes say, by the ranks of the communicator. Collective, and
  /// so is all else that is built on the grid over the same ranks.
  Grid(const petsc::Communicator& communicator, const std::array<basis::NodeLine, dim>& nodes,
       const partition::Layout<dim>& ranges);
  Grid(const Grid&) = delete;
  Grid& operator=(const Grid&) = delete;

  const basis::NodeLine& nodes(int d) const { return m_nodes[d]; }
  DM dm() const { return m_dm; }
  const petsc::Communicator& communicator() const { return m_communicator; }

  /// Gives cells and nodes to other ranks; the same on all. Nodal fields start anew when they are
  /// used next, particles have to migrate before. Local.
  void set_ownership(partition::Ownership<dim> ownership);
  const partition::Ownership<dim>& ownership() const { return m_ownership; }
  /// Goes up with every new ownership.
  int ownership_version() const { return m_ownership_version; }
  int rank() const { return m_rank; }
  int rank_of_cell(const Index& cell) const { return m_ownership.rank_of(cell); }
  int rank_of_node(const Index& node) const;

  /// The box of this rank's local arrays: its own nodes and the ghosts around them.
  const Box<dim>& ghosted_nodes() const { return m_ghosted; }
  /// The same of any rank; no communication.
  const Box<dim>& ghosted_nodes_of(int rank) const {
    return m_ghosted_of[static_cast<std::size_t>(rank)];
  }
  int local_size() const { return m_ghosted.size(); }

  /// Position of a node in the local arrays.
  int local_index(const Index& node) const { return m_ghosted.index_of(node); }
  Vector<dim> position(const Index& node) const {
    Vector<dim> x;
    for (int d = 0; d < dim; ++d) x[d] = m_nodes[d].positions[static_cast<std::size_t>(node[d])];
    return x;
  }

  /// The cell that holds x; outside the grid an index is -1 or the number of cells.
  Index cell_of(const Vector<dim>& x) const {
    Index cell;
    for (int d = 0; d < dim; ++d) cell[d] = m_nodes[d].lines.cell_of(x[d]);
    return cell;
  }
  Box<dim> all_nodes() const {
    Box<dim> box;
    for (int d = 0; d < dim; ++d) box.end[d] = m_nodes[d].count();
    return box;
  }
  Box<dim> all_cells() const {
    Box<dim> box;
    for (int d = 0; d < dim; ++d) box.end[d] = m_nodes[d].lines.cells();
    return box;
  }

  /// Cells whose particles belong to this rank.
  const CellSet<dim>& owned_cells() const { return m_owned_cells; }
  /// Cells whose particles this rank can still carry: the owned ones and one cell of drift.
  const CellSet<dim>& reachable_cells() const { return m_reachable_cells; }

  /// Says which cells of the whole grid may hold particles until it is said again; the same on all
  /// ranks. Nodes that these do not reach cost nothing in a step.
  void set_active_cells(const Box<dim>& cells);
  /// What was said last.
  const Box<dim>& active_box() const { return m_active_box; }
  /// Active cells whose particles this rank can carry.
  const CellSet<dim>& active_cells() const { return m_active_cells; }
  /// Goes up whenever the active nodes become others.
  int active_version() const { return m_active_version; }

  long long global_cells() const;

  /// Owned nodes that a step needs.
  const std::vector<Run<dim>>& active_runs() const { return m_active_runs; }
  /// All local nodes that a step needs, ghosts too.
  const std::vector<Run<dim>>& active_local_runs() const { return m_active_local_runs; }

  /// Visits the owned nodes in local order: visit(local index, node).
  template <class Visit>
  void for_each_owned_node(const Visit& visit) const {
    for_each_node_of(m_owned_runs, visit);
  }
  /// The same for those that a step needs.
  template <class Visit>
  void for_each_active_node(const Visit& visit) const {
    for_each_node_of(m_active_runs, visit);
  }
  /// The same a piece of the local arrays at a time: visit(first local index, count).
  template <class Visit>
  void for_each_active_run(const Visit& visit) const {
    for (const Run<dim>& run : m_active_runs) visit(run.first, run.count);
  }
  /// The nodes that reachable cells touch, owned ones and ghosts.
  template <class Visit>
  void for_each_local_node(const Visit& visit) const {
    for_each_node_of(m_local_runs, visit);
  }
  /// Local indices of the owned nodes in layer a, counted from the first or last (side 0, 1) of
  /// direction d; a < support.
  const std::vector<int>& end_layer(int d, int side, int a) const {
    return m_end_layers[d][static_cast<std::size_t>(side)][static_cast<std::size_t>(a)];
  }

  /// Nodes of this rank in global vectors of the DMDA.
  const Box<dim>& recorded_nodes() const { return m_recorded; }
  /// What the owners of these nodes hold in their local arrays, in the order of a global vector.
  /// Collective.
  std::vector<double> to_record(const double* local) const;

  /// Nodes beside its own that a rank of ranges has to be able to hold.
  static int stencil_width(const basis::NodeLine& nodes) {
    return nodes.support - nodes.owner_offset;
  }

 private:
  template <class Visit>
  static void for_each_node_of(const std::vector<Run<dim>>& runs, const Visit& visit) {
    for (const Run<dim>& run : runs) {
      Index node = run.node;
      for (int k = 0; k < run.count; ++k, ++node[0]) visit(run.first + k, node);
    }
  }
  void find_boxes();
  void mark_cells();
  void find_runs();
  void find_end_layers();
  void find_active_runs();
  void connect_record() const;

  petsc::Communicator m_communicator;
  std::array<basis::NodeLine, dim> m_nodes;
  int m_rank, m_ranks;
  petsc::DmHandle m_dm;
  Box<dim> m_recorded;
  partition::Ownership<dim> m_ownership;
  int m_ownership_version = 0;

  std::vector<Box<dim>> m_ghosted_of;  ///< of every rank
  Box<dim> m_ghosted;
  Box<dim> m_own_box;      ///< around the owned cells
  Box<dim> m_local_cells;  ///< those whose nodes are all in m_ghosted
  Marks m_cell_marks;      ///< of these
  CellSet<dim> m_owned_cells, m_reachable_cells, m_active_cells;
  std::vector<Run<dim>> m_owned_runs, m_local_runs;
  std::array<std::array<std::vector<std::vector<int>>, 2>, dim> m_end_layers;

  Box<dim> m_active_box;  ///< of the whole grid
  std::vector<Run<dim>> m_active_runs, m_active_local_runs;
  int m_active_version = 0;

  mutable petsc::StarForestHandle m_record;  ///< from local arrays of owners to the DMDA's vectors
  mutable int m_record_version = -1;
};

extern template class Grid<1>;
extern template class Grid<2>;
extern template class Grid<3>;

}  // namespace mpm::grid
