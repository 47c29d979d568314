#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "mpm/material/Material.hpp"
#include "mpm/particles/Swarm.hpp"

namespace mpm::particles {

template <int dim>
class ParticleView;

using Materials = std::vector<std::shared_ptr<const material::Material>>;

/// Columns that only some runs need.
struct OptionalColumns {
  bool velocity_gradient = false;  ///< of the particle's own motion, carried by affine transfers
  bool softening_before = false;   ///< laws' softening states when they were last averaged
  std::vector<std::string> contacts = {};  ///< labels of contacts found at particles
};

/// Field with the value that a softening state had when it was last averaged.
inline std::string name_before_averaging(std::string_view state) {
  return std::string(state) + "_before_averaging";
}

enum class Shape {
  scalar,
  vector,
  symmetric_tensor,
  matrix,   ///< row by row
  integer,  ///< a whole number
  id        ///< the 64-bit number that the swarm itself keeps
};

enum class Role {
  state,          ///< kept from step to step: what a restart needs
  written_state,  ///< the same, and written out
  derived         ///< found from the state where it is written out, a scalar or an integer
};

/// What a particle field is. One declaration, in the table of FieldTable.cpp or by a law: columns,
/// initial values, migration, sorting and output follow.
template <int dim>
struct Field {
  std::string name;       ///< identifier, also in files
  std::string long_name;  ///< for people, with the sign convention where there is one
  std::string unit;       ///< SI, "1" when dimensionless
  Shape shape;
  Role role;
  /// Value of a derived field at particle p.
  std::function<double(const ParticleView<dim>&, int p)> value = nullptr;
  /// Of every component of a new particle, unless its seed or its law says another.
  double initial = 0.0;
};

/// Where the columns of a field are: asked for by name once, good for all views of these particles.
template <class Value>
class ColumnHandle {
  template <int dim>
  friend class FieldTable;
  template <int dim>
  friend class ParticleView;

  explicit ColumnHandle(std::size_t first_column) : m_first_column(first_column) {}
  std::size_t m_first_column;
};

/// Of real numbers, as all states of laws are.
using StateHandle = ColumnHandle<double>;

/// All fields of the particles of a run, those of their laws included.
template <int dim>
class FieldTable {
 public:
  using Column = typename Swarm<dim>::Column;
  using Type = typename Swarm<dim>::Type;

  /// A variable that laws share is one field. Throws BadInput if they give it different units or if
  /// it has the name of another field.
  FieldTable(const Materials& materials, const OptionalColumns& optional);

  const std::vector<Field<dim>>& all() const { return m_fields; }
  bool has(std::string_view name) const { return find(name) < m_fields.size(); }
  /// Throws BadInput if there is none of that name.
  const Field<dim>& named(std::string_view name) const;

  /// Of a field with columns of this kind: double, or PetscInt for integers. Throws BadInput for
  /// any other: derived fields and the id have none.
  template <class Value = double>
  ColumnHandle<Value> handle(std::string_view name) const {
    return ColumnHandle<Value>(first_column(name, type_of<Value>));
  }
  /// Of all state variables of a law, in the order in which it declares them.
  std::span<const StateHandle> states(int material) const {
    return m_states[static_cast<std::size_t>(material)];
  }

  /// What the swarm has to register: position_x, stress_xy, mass.
  const std::vector<Column>& columns() const { return m_columns; }
  /// Gives all columns of a new particle their initial values, but those of its law's state.
  void set_initial(const ParticleView<dim>& view, int p) const;

  /// Scalars that make up a field of this shape.
  static int components(Shape shape);

 private:
  template <class Value>
  static constexpr Type type_of = std::is_same_v<Value, double> ? Type::real : Type::integer;

  std::size_t find(std::string_view name) const;
  std::size_t first_column(std::string_view name, Type type) const;
  void add(Field<dim> field);
  void add_states(const material::Material& law, std::size_t own);
  void add_softening_before(const material::Material& law);

  std::vector<Field<dim>> m_fields;
  std::vector<std::size_t> m_first_column;         ///< of each field
  std::vector<std::vector<StateHandle>> m_states;  ///< of each material
  std::vector<Column> m_columns;
  std::vector<double> m_initial;  ///< of each column
};

extern template class FieldTable<1>;
extern template class FieldTable<2>;
extern template class FieldTable<3>;

}  // namespace mpm::particles
