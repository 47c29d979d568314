#include "mpm/grid/NodalField.hpp"

#include <algorithm>
#include <utility>

#include "mpm/petsc/Error.hpp"

namespace mpm::grid {
namespace {

/// A star forest from the ghost nodes of this rank (leaves) to the owners' entries (roots), for
/// all components at once. The owner's local numbering follows from the layout, so that building
/// it needs no communication of indices.
template <int dim>
void create_halo(const Grid<dim>& grid, int components, PetscSF* halo) {
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  for (int c = 0; c < components; ++c) {
    grid.for_each_node(grid.ghosted_nodes(), [&](int local, const std::array<int, dim>& node) {
      if (grid.owned_nodes().contains(node)) return;
      std::array<int, dim> process;
      for (int d = 0; d < dim; ++d) process[d] = grid.layout().process_of(d, node[d]);
      const Box<dim> box = grid.ghosted_box_of(process);
      leaves.push_back(c * grid.local_size() + local);
      roots.push_back(
          {grid.layout().rank_of(process), c * box.size() + Grid<dim>::index_in(box, node)});
    });
  }
  MPM_PETSC(PetscSFCreate(PETSC_COMM_WORLD, halo));
  MPM_PETSC(PetscSFSetGraph(*halo, components * grid.local_size(),
                            static_cast<PetscInt>(leaves.size()), leaves.data(), PETSC_COPY_VALUES,
                            roots.data(), PETSC_COPY_VALUES));
  MPM_PETSC(PetscSFSetUp(*halo));
}

}  // namespace

template <int dim>
NodalField<dim>::NodalField(const Grid<dim>& grid, std::vector<Component> components)
    : m_grid(grid), m_components(std::move(components)) {
  const auto size = static_cast<PetscInt>(m_components.size()) * grid.local_size();
  MPM_PETSC(VecCreateSeq(PETSC_COMM_SELF, size, m_vector.address()));
  MPM_PETSC(VecGetArray(m_vector, &m_values));
  create_halo(grid, this->components(), m_halo.address());
}

template <int dim>
NodalField<dim>::~NodalField() {
  VecRestoreArray(m_vector, &m_values);
}

template <int dim>
void NodalField<dim>::set_to_zero() {
  std::fill_n(m_values, m_components.size() * static_cast<std::size_t>(m_grid.local_size()), 0.0);
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
  MPM_PETSC(PetscSFReduceBegin(m_halo, MPIU_SCALAR, m_values, m_values, MPI_SUM));
  MPM_PETSC(PetscSFReduceEnd(m_halo, MPIU_SCALAR, m_values, m_values, MPI_SUM));
}

template <int dim>
void NodalField<dim>::copy_to_ghosts() {
  MPM_PETSC(PetscSFBcastBegin(m_halo, MPIU_SCALAR, m_values, m_values, MPI_REPLACE));
  MPM_PETSC(PetscSFBcastEnd(m_halo, MPIU_SCALAR, m_values, m_values, MPI_REPLACE));
}

template <int dim>
petsc::VecHandle NodalField<dim>::global_vector(int c) const {
  petsc::VecHandle vector;
  MPM_PETSC(DMCreateGlobalVector(m_grid.dm(), vector.address()));
  double* owned = nullptr;
  MPM_PETSC(VecGetArray(vector, &owned));
  const double* local = values(c);
  m_grid.for_each_owned_node([&](int index, const auto&) { *owned++ = local[index]; });
  owned -= m_grid.owned_nodes().size();
  MPM_PETSC(VecRestoreArray(vector, &owned));
  return vector;
}

template class NodalField<1>;
template class NodalField<2>;
template class NodalField<3>;

}  // namespace mpm::grid
