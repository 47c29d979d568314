#include "mpm/grid/NodalField.hpp"

#include <algorithm>
#include <utility>

#include "mpm/core/Simd.hpp"
#include "mpm/petsc/Error.hpp"
#include "mpm/petsc/Log.hpp"

namespace mpm::grid {
namespace {

/// A star forest from the ghost nodes of this rank (leaves) to the owners' entries (roots), for
/// all components at once. The owner's local numbering follows from the ownership, so that
/// building it needs no communication of indices.
template <int dim>
void create_halo(const Grid<dim>& grid, int components, PetscSF* halo) {
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  for (int c = 0; c < components; ++c) {
    grid.for_each_local_node([&](int local, const std::array<int, dim>& node) {
      const int owner = grid.rank_of_node(node);
      if (owner == grid.rank()) return;
      const Box<dim>& box = grid.ghosted_nodes_of(owner);
      leaves.push_back(c * grid.local_size() + local);
      roots.push_back({owner, c * box.size() + box.index_of(node)});
    });
  }
  MPM_PETSC(PetscSFCreate(grid.communicator(), halo));
  MPM_PETSC(PetscSFSetGraph(*halo, components * grid.local_size(),
                            static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  MPM_PETSC(PetscSFSetUp(*halo));
}

}  // namespace

template <int dim>
NodalField<dim>::NodalField(const Grid<dim>& grid, std::vector<Component> components)
    : m_grid(grid), m_components(std::move(components)) {
  renew_values();
  halo();
}

template <int dim>
NodalField<dim>::~NodalField() {
  VecRestoreArray(m_vector, &m_values);
}

template <int dim>
void NodalField<dim>::renew_values() {
  const auto size =
      static_cast<PetscInt>(m_components.size()) * m_grid.local_size() + simd::lanes - 1;
  if (m_values != nullptr) MPM_PETSC(VecRestoreArray(m_vector, &m_values));
  m_vector.reset();
  MPM_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, m_vector.address()));
  MPM_PETSC(VecGetArray(m_vector, &m_values));
  m_version = m_grid.ownership_version();
}

template <int dim>
PetscSF NodalField<dim>::halo() {
  if (m_halo_version != m_grid.ownership_version()) {
    m_halo.reset();
    create_halo(m_grid, components(), m_halo.address());
    m_halo_version = m_grid.ownership_version();
  }
  return m_halo;
}

template <int dim>
void NodalField<dim>::set_to_zero() {
  std::fill_n(values(0), m_components.size() * static_cast<std::size_t>(m_grid.local_size()), 0.0);
}

template <int dim>
void NodalField<dim>::set_active_to_zero() {
  if (m_zeroed_version != m_grid.active_version()) {
    set_to_zero();
    m_zeroed_version = m_grid.active_version();
    return;
  }
  for (int c = 0; c < components(); ++c) {
    double* const value = values(c);
    for (const Run<dim>& run : m_grid.active_local_runs())
      std::fill_n(value + run.first, run.count, 0.0);
  }
}

template <int dim>
void NodalField<dim>::sum_to_owners() {
  const petsc::Phase phase("mpm: halo sum");
  double* const all = values(0);
  MPM_PETSC(PetscSFReduceBegin(halo(), MPIU_SCALAR, all, all, MPI_SUM));
  MPM_PETSC(PetscSFReduceEnd(m_halo, MPIU_SCALAR, all, all, MPI_SUM));
}

template <int dim>
void NodalField<dim>::copy_to_ghosts() {
  const petsc::Phase phase("mpm: halo copy");
  double* const all = values(0);
  MPM_PETSC(PetscSFBcastBegin(halo(), MPIU_SCALAR, all, all, MPI_REPLACE));
  MPM_PETSC(PetscSFBcastEnd(m_halo, MPIU_SCALAR, all, all, MPI_REPLACE));
}

template <int dim>
petsc::VecHandle NodalField<dim>::global_vector(int c) const {
  petsc::VecHandle vector;
  MPM_PETSC(DMCreateGlobalVector(m_grid.dm(), vector.address()));
  double* entries = nullptr;
  MPM_PETSC(VecGetArray(vector, &entries));
  std::ranges::copy(m_grid.to_record(values(c)), entries);
  MPM_PETSC(VecRestoreArray(vector, &entries));
  return vector;
}

template class NodalField<1>;
template class NodalField<2>;
template class NodalField<3>;

}  // namespace mpm::grid
