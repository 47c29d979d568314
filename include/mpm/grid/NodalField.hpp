#pragma once

#include <vector>

#include "mpm/grid/Grid.hpp"

namespace mpm::grid {

/// How a component of a nodal field behaves at a wall.
struct Component {
  static constexpr int scalar = -1;
  int direction = scalar;  ///< direction of a vector component, or `scalar`
};

/// Several components on the nodes of a rank's ghosted box, one x-contiguous slice each, in one
/// PETSc Vec; sums over and copies to the ghosts go as one message per neighbour. Behind the last
/// slice there is room for a pack, so that packs may begin at any node. Once cells and nodes have
/// got other owners the field is zero: pointers to its values have to be asked for anew.
template <int dim>
class NodalField {
 public:
  /// Collective.
  NodalField(const Grid<dim>& grid, std::vector<Component> components);
  ~NodalField();
  NodalField(const NodalField&) = delete;
  NodalField& operator=(const NodalField&) = delete;

  int components() const { return static_cast<int>(m_components.size()); }
  Component component(int c) const { return m_components[static_cast<std::size_t>(c)]; }
  double* values(int c) {
    if (m_version != m_grid.ownership_version()) renew_values();
    return m_values + static_cast<std::ptrdiff_t>(c) * m_grid.local_size();
  }
  const double* values(int c) const { return const_cast<NodalField*>(this)->values(c); }

  void set_to_zero();
  /// The same, knowing that only active nodes have been written since the last time.
  void set_active_to_zero();

  /// Adds what this rank holds on nodes of others to their owners. Collective.
  void sum_to_owners();
  /// Refreshes this rank's copies of nodes of others. Collective.
  void copy_to_ghosts();

  /// What the owners hold of one component, as a global Vec of the DMDA. Collective.
  petsc::VecHandle global_vector(int c) const;

 private:
  void renew_values();
  /// Collective.
  PetscSF halo();

  const Grid<dim>& m_grid;
  std::vector<Component> m_components;
  petsc::VecHandle m_vector;
  double* m_values = nullptr;
  petsc::StarForestHandle m_halo;
  int m_version = -1;         ///< of the ownership that the values are laid out for
  int m_halo_version = -1;    ///< of the ownership that the halo connects
  int m_zeroed_version = -1;  ///< of the grid's active nodes when all was last zero
};

extern template class NodalField<1>;
extern template class NodalField<2>;
extern template class NodalField<3>;

}  // namespace mpm::grid
