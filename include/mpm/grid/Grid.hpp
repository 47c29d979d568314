#pragma once

#include <petscdmda.h>

#include <algorithm>
#include <array>
#include <vector>

#include "mpm/basis/BSpline.hpp"
#include "mpm/core/Tensor.hpp"
#include "mpm/partition/Layout.hpp"
#include "mpm/petsc/Handle.hpp"

namespace mpm::grid {

/// Half-open box of node or cell indices.
template <int dim>
struct Box {
  std::array<int, dim> begin{};
  std::array<int, dim> end{};

  bool contains(const std::array<int, dim>& index) const {
    for (int d = 0; d < dim; ++d)
      if (index[d] < begin[d] || index[d] >= end[d]) return false;
    return true;
  }
  bool operator==(const Box&) const = default;
  int extent(int d) const { return end[d] - begin[d]; }
  int size() const {
    int product = 1;
    for (int d = 0; d < dim; ++d) product *= extent(d);
    return product;
  }
};

/// What two boxes share; empty in a direction where they share nothing.
template <int dim>
Box<dim> intersection(const Box<dim>& a, const Box<dim>& b) {
  Box<dim> box;
  for (int d = 0; d < dim; ++d) {
    box.begin[d] = std::max(a.begin[d], b.begin[d]);
    box.end[d] = std::max(box.begin[d], std::min(a.end[d], b.end[d]));
  }
  return box;
}

/// Nodes that follow each other along the first direction, and so in the local arrays.
template <int dim>
struct Run {
  int first;  ///< position in the local arrays
  int count;
  std::array<int, dim> node;  ///< the first one
};

/// The background grid: a PETSc DMDA of spline nodes, and which nodes and cells are this rank's.
/// A rank's local arrays cover its ghosted box, first direction fastest.
template <int dim>
class Grid {
 public:
  using Index = std::array<int, dim>;

  /// Collective.
  Grid(const std::array<basis::NodeLine, dim>& nodes, const partition::Layout<dim>& layout);

  const basis::NodeLine& nodes(int d) const { return m_nodes[d]; }
  const partition::Layout<dim>& layout() const { return m_layout; }
  DM dm() const { return m_dm; }

  const Box<dim>& owned_nodes() const { return m_owned; }
  const Box<dim>& ghosted_nodes() const { return m_ghosted; }
  int local_size() const { return m_ghosted.size(); }

  /// Position of a node in the local arrays.
  int local_index(const Index& node) const { return index_in(m_ghosted, node); }
  static int index_in(const Box<dim>& box, const Index& node) {
    int index = 0;
    for (int d = dim - 1; d >= 0; --d) index = index * box.extent(d) + node[d] - box.begin[d];
    return index;
  }
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
  Box<dim> all_cells() const {
    Box<dim> box;
    for (int d = 0; d < dim; ++d) box.end[d] = m_nodes[d].lines.cells();
    return box;
  }

  /// Cells whose particles belong to this rank.
  const Box<dim>& owned_cells() const { return m_owned_cells; }
  /// Cells whose particles this rank can still carry: the owned ones and one cell of drift.
  const Box<dim>& reachable_cells() const { return m_reachable_cells; }

  /// Says which cells of the whole grid may hold particles until it is said again; the same on all
  /// ranks. Nodes that these do not reach cost nothing in a step.
  void set_active_cells(const Box<dim>& cells);
  /// Active cells whose particles this rank can carry.
  const Box<dim>& active_cells() const { return m_active_cells; }
  /// Nodes of this rank's ghosted box that active cells of any rank reach.
  const Box<dim>& active_nodes() const { return m_active_nodes; }
  /// Goes up whenever the active nodes become others.
  int active_version() const { return m_active_version; }

  int rank_of_cell(const Index& cell) const;
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
  template <class Visit>
  void for_each_node(const Box<dim>& box, const Visit& visit) const {
    for_each_node_of(runs_of(box), visit);
  }

  /// Nodes of stencil width beside the owned ones that particles of reachable cells touch.
  static int stencil_width(const basis::NodeLine& nodes) {
    return nodes.support - nodes.owner_offset;
  }

  /// Owned and ghosted boxes of any process; no communication.
  Box<dim> owned_box_of(const Index& process) const;
  Box<dim> ghosted_box_of(const Index& process) const;

 private:
  template <class Visit>
  static void for_each_node_of(const std::vector<Run<dim>>& runs, const Visit& visit) {
    for (const Run<dim>& run : runs) {
      Index node = run.node;
      for (int k = 0; k < run.count; ++k, ++node[0]) visit(run.first + k, node);
    }
  }
  std::vector<Run<dim>> runs_of(const Box<dim>& box) const;

  std::array<basis::NodeLine, dim> m_nodes;
  partition::Layout<dim> m_layout;
  petsc::DmHandle m_dm;
  Box<dim> m_owned, m_ghosted, m_owned_cells, m_reachable_cells;
  Box<dim> m_active_cells, m_active_nodes;
  std::vector<Run<dim>> m_owned_runs, m_active_runs, m_active_local_runs;
  int m_active_version = 0;
};

extern template class Grid<1>;
extern template class Grid<2>;
extern template class Grid<3>;

}  // namespace mpm::grid
