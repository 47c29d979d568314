#include "mpm/particles/FieldTable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/core/Errors.hpp"
#include "mpm/particles/Particles.hpp"

namespace mpm::particles {
namespace {

template <int dim>
double mean_pressure(const ParticleView<dim>& view, int p) {
  return -trace(view.stress_of(p)) / 3.0;
}

template <int dim>
double deviatoric_stress(const ParticleView<dim>& view, int p) {
  return std::sqrt(1.5) * norm(deviator(view.stress_of(p)));
}

template <int dim>
double rank(const ParticleView<dim>& view, int) {
  return view.rank;
}

/// The one table of what every particle has, whatever its law. Lengths left out count 1 m.
template <int dim>
std::vector<Field<dim>> declared_fields(const OptionalColumns& optional) {
  using enum Shape;
  using enum Role;
  std::vector<Field<dim>> fields{
      {"position", "position", "m", vector, state},
      {"velocity", "velocity", "m/s", vector, written_state},
      {"displacement", "displacement since the start of loading", "m", vector, written_state},
      {"stress", "Cauchy stress, tension positive: xx yy zz xy yz xz", "Pa", symmetric_tensor,
       written_state},
      {"p", "mean stress, compression positive", "Pa", scalar, derived, mean_pressure<dim>},
      {"q", "deviatoric stress sqrt(3/2 s:s)", "Pa", scalar, derived, deviatoric_stress<dim>},
      {"deviatoric_strain", "accumulated deviatoric strain", "1", scalar, written_state},
      {"mass", "mass", "kg", scalar, state},
      {"volume", "volume", "m^3", scalar, written_state},
      {"id", "number of the particle, whatever the ranks", "1", id, written_state},
      {"material", "number of the material", "1", integer, written_state},
      {"rank", "rank that has the particle", "1", integer, derived, rank<dim>},
  };
  if (optional.velocity_gradient)
    fields.push_back({"velocity_gradient", "gradient dv_i/dx_j of the particle's own motion", "1/s",
                      matrix, state});
  if (!optional.contacts.empty())
    fields.push_back({"extent", "squares of the half extents: xx yy zz xy yz xz", "m^2",
                      symmetric_tensor, state});
  constexpr double unseen = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& label : optional.contacts) {
    const std::string body = "the rigid body of '" + label + "'";
    fields.push_back({label + "_force", "force by springs of " + body, "N", vector, written_state});
    fields.push_back({label + "_place", "place in the frame of " + body, "m", vector, state});
    fields.push_back(
        {label + "_overlap", "overlap with " + body, "m", scalar, state, nullptr, unseen});
    fields.push_back({label + "_reach",
                      "where its soil ends towards " + body + ", over its half extent", "1", scalar,
                      state});
  }
  return fields;
}

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
constexpr std::array<const char*, 6> tensor_names{"xx", "yy", "zz", "xy", "yz", "xz"};

template <int dim>
std::string column_name(const Field<dim>& field, int component) {
  const auto k = static_cast<std::size_t>(component);
  switch (field.shape) {
    case Shape::vector:
      return field.name + "_" + axis_names[k];
    case Shape::symmetric_tensor:
      return field.name + "_" + tensor_names[k];
    case Shape::matrix:
      return field.name + "_" + axis_names[k / dim] + axis_names[k % dim];
    default:
      return field.name;
  }
}

template <int dim>
bool has_columns(const Field<dim>& field) {
  return field.role != Role::derived && field.shape != Shape::id;
}

}  // namespace

template <int dim>
FieldTable<dim>::FieldTable(const Materials& materials, const OptionalColumns& optional) {
  for (Field<dim>& field : declared_fields<dim>(optional)) add(std::move(field));
  const std::size_t own = m_fields.size();
  for (const auto& law : materials) add_states(*law, own);
  if (!optional.softening_before) return;
  for (const auto& law : materials) add_softening_before(*law);
}

template <int dim>
void FieldTable<dim>::add(Field<dim> field) {
  m_first_column.push_back(m_columns.size());
  if (has_columns(field)) {
    const Type type = field.shape == Shape::integer ? Type::integer : Type::real;
    for (int k = 0; k < components(field.shape); ++k) {
      m_columns.push_back({column_name(field, k), type});
      m_initial.push_back(field.initial);
    }
  }
  m_fields.push_back(std::move(field));
}

/// `own` is the number of fields that are no law's.
template <int dim>
void FieldTable<dim>::add_states(const material::Material& law, std::size_t own) {
  std::vector<StateHandle>& states = m_states.emplace_back();
  for (const material::StateVariable& variable : law.state_variables()) {
    const std::size_t k = find(variable.name);
    if (k == m_fields.size())
      add({variable.name, variable.long_name, variable.unit, Shape::scalar, Role::written_state});
    else if (k < own || m_fields[k].unit != variable.unit)
      throw BadInput(fmt::format(
          "law '{}' declares '{}' in {}, which is there in {} already: give it another name",
          law.name(), variable.name, variable.unit, m_fields[k].unit));
    states.push_back(StateHandle(m_first_column[k]));
  }
}

template <int dim>
void FieldTable<dim>::add_softening_before(const material::Material& law) {
  for (const material::StateVariable& variable : law.state_variables()) {
    const std::string name = name_before_averaging(variable.name);
    if (variable.role != material::StateRole::softening || has(name)) continue;
    add({name, variable.long_name + ", when last averaged", variable.unit, Shape::scalar,
         Role::state});
  }
}

template <int dim>
std::size_t FieldTable<dim>::find(std::string_view name) const {
  const auto found = std::ranges::find(m_fields, name, &Field<dim>::name);
  return static_cast<std::size_t>(found - m_fields.begin());
}

template <int dim>
const Field<dim>& FieldTable<dim>::named(std::string_view name) const {
  const std::size_t k = find(name);
  if (k == m_fields.size()) throw BadInput(fmt::format("particles have no field '{}'", name));
  return m_fields[k];
}

template <int dim>
std::size_t FieldTable<dim>::first_column(std::string_view name, Type type) const {
  const Field<dim>& field = named(name);
  const std::size_t column = m_first_column[find(name)];
  if (!has_columns(field) || m_columns[column].type != type)
    throw BadInput(fmt::format("the particle field '{}' has no columns of {} numbers", name,
                               type == Type::real ? "real" : "whole"));
  return column;
}

template <int dim>
void FieldTable<dim>::set_initial(const ParticleView<dim>& view, int p) const {
  for (std::size_t c = 0; c < m_columns.size(); ++c)
    if (m_columns[c].type == Type::real)
      view[ColumnHandle<double>(c)][p] = m_initial[c];
    else
      view[ColumnHandle<PetscInt>(c)][p] = static_cast<PetscInt>(m_initial[c]);
}

template <int dim>
int FieldTable<dim>::components(Shape shape) {
  switch (shape) {
    case Shape::vector:
      return dim;
    case Shape::symmetric_tensor:
      return tensor_components<dim>;
    case Shape::matrix:
      return dim * dim;
    default:
      return 1;
  }
}

template class FieldTable<1>;
template class FieldTable<2>;
template class FieldTable<3>;

}  // namespace mpm::particles
