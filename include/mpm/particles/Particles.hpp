#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mpm/grid/Grid.hpp"
#include "mpm/material/Material.hpp"
#include "mpm/particles/FieldTable.hpp"
#include "mpm/particles/Swarm.hpp"

namespace mpm::particles {

/// The particles [first, last) of a rank.
struct Range {
  int first = 0;
  int last = 0;

  int size() const { return std::max(0, last - first); }
};

inline Range intersection(const Range& a, const Range& b) {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

/// A particle to be made.
template <int dim>
struct Seed {
  std::int64_t id;  ///< unique over all ranks and independent of their number
  Vector<dim> position;
  Vector<dim> velocity{};
  double volume;  ///< m^3 per unit of the dimensions left out
  int material = 0;
};

/// Where the columns are that a view has members for: views are opened once a step.
template <int dim>
struct MemberHandles {
  explicit MemberHandles(const FieldTable<dim>& fields);

  StateHandle position, velocity, displacement, stress, mass, volume, deviatoric_strain;
  ColumnHandle<PetscInt> material;
  std::optional<StateHandle> velocity_gradient, extent;
};

/// Pointers into the swarm's arrays, one per scalar component. While one exists the swarm cannot
/// change its size.
template <int dim>
class ParticleView {
 public:
  ParticleView(const Swarm<dim>& swarm, const FieldTable<dim>& fields,
               const MemberHandles<dim>& members);

  int count = 0;
  int rank = 0;  ///< that has these particles
  std::array<double*, dim> position, velocity, displacement;
  double* mass = nullptr;
  double* volume = nullptr;
  std::array<double*, SymmetricTensor::size> stress{};  ///< null where a component is always zero
  double* deviatoric_strain = nullptr;                  ///< sum of sqrt(2/3 e:e) of the increments
  /// dv_i/dx_j of the particle's own motion, 1/s; null unless the run has it.
  std::array<std::array<double*, dim>, dim> velocity_gradient{};
  /// Of the ellipsoid x.A^-1 x = 1 that stands for the particle's extent, m^2; null unless the run
  /// has it.
  std::array<double*, SymmetricTensor::size> extent{};
  std::int64_t* id = nullptr;
  PetscInt* material = nullptr;

  /// The values of any scalar field, such as a law's state.
  template <class Value>
  Value* operator[](ColumnHandle<Value> handle) const {
    return column(handle, 0);
  }
  /// The values of a component of any field.
  template <class Value>
  Value* column(ColumnHandle<Value> handle, int component) const {
    return static_cast<Value*>(m_data[handle.m_first_column + static_cast<std::size_t>(component)]);
  }

  Vector<dim> position_of(int p) const { return gather(position, p); }
  Vector<dim> velocity_of(int p) const { return gather(velocity, p); }
  SymmetricTensor stress_of(int p) const {
    SymmetricTensor value;
    for (int k = 0; k < tensor_components<dim>; ++k)
      value[k] = stress[static_cast<std::size_t>(k)][p];
    return value;
  }

 private:
  static Vector<dim> gather(const std::array<double*, dim>& field, int p) {
    Vector<dim> value;
    for (int d = 0; d < dim; ++d) value[d] = field[d][p];
    return value;
  }

  void point_to(StateHandle handle, std::span<double*> components);

  OpenColumns m_open;
  std::vector<void*> m_data;  ///< of every column, in the order of the table
};

/// The material points: a DMSwarm (BASIC) with one field per scalar component, kept in the order
/// material, cell. Particles may drift one cell past their rank's cells before they migrate.
template <int dim>
class Particles {
 public:
  /// Collective. `grid` must outlive the particles and learns where they are.
  Particles(grid::Grid<dim>& grid, Materials materials, OptionalColumns optional = {});

  /// Adds particles that lie in cells of this rank, then sorts. Collective.
  void add(std::span<const Seed<dim>> seeds);

  /// Sends every particle to the rank that owns its cell, checks that none was lost, and sorts.
  /// Collective; throws NumericalFailure on all ranks if one left the grid.
  void migrate();

  /// Orders the particles of this rank by material and cell, and tells the grid which cells hold
  /// some. Collective.
  void sort();

  ParticleView<dim> view() const { return {m_swarm, m_fields, m_members}; }

  /// See Swarm. Columns are those of all fields that are not derived.
  template <class Visit>
  void for_each_column(const Visit& visit) const {
    m_swarm.for_each_column(visit);
  }
  void replace(int count) { m_swarm.replace(count); }
  /// Takes particles that have been put back in the order in which they are, which is that of a
  /// former sort. Throws BadInput where materials are not one after another or unknown. Local.
  void keep_order();

  /// The particles of a material after the last sort.
  Range range_of(int material) const { return m_ranges[static_cast<std::size_t>(material)]; }
  /// Views of one material's stress and state; the strain increments are left to the caller.
  material::Batch batch_of(const ParticleView<dim>& view, int material) const {
    return batch_of(view, material, range_of(material));
  }
  /// The same of a part of its particles.
  material::Batch batch_of(const ParticleView<dim>& view, int material, const Range& part) const;

  /// Particles of all ranks in every cell of the grid. Collective.
  partition::CellWork<dim> count_in_cells() const;

  /// Another number whenever particles may have changed their places in a view.
  long long order() const { return m_order; }
  const petsc::Communicator& communicator() const { return m_swarm.communicator(); }
  int local_count() const { return m_swarm.local_count(); }
  long long global_count() const { return m_swarm.global_count(); }
  const Materials& materials() const { return m_materials; }
  const FieldTable<dim>& fields() const { return m_fields; }
  /// Of a state variable of a law. Throws BadInput, which names the law and what it has.
  StateHandle state(int material, std::string_view name) const;
  /// Memory of one particle in the swarm, bytes.
  std::size_t bytes_per_particle() const { return m_swarm.bytes_per_point(); }

 private:
  std::vector<std::array<int, dim>> cells() const;
  std::vector<int> sort_keys(const ParticleView<dim>& view) const;
  void fill(const Seed<dim>& seed, const ParticleView<dim>& view, int p) const;

  void renew_active_cells() const;

  grid::Grid<dim>& m_grid;
  Materials m_materials;
  FieldTable<dim> m_fields;
  MemberHandles<dim> m_members;
  Swarm<dim> m_swarm;
  std::vector<Range> m_ranges;
  long long m_order = 0;
};

extern template struct MemberHandles<1>;
extern template struct MemberHandles<2>;
extern template struct MemberHandles<3>;
extern template class ParticleView<1>;
extern template class ParticleView<2>;
extern template class ParticleView<3>;
extern template class Particles<1>;
extern template class Particles<2>;
extern template class Particles<3>;

}  // namespace mpm::particles
