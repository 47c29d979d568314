#include "mpm/particles/Particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Log.hpp"

namespace mpm::particles {
namespace {

std::string names(std::span<const material::StateVariable> variables) {
  std::vector<std::string> names;
  for (const auto& variable : variables) names.push_back(variable.name);
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

template <int dim>
MemberHandles<dim>::MemberHandles(const FieldTable<dim>& fields)
    : position(fields.handle("position")),
      velocity(fields.handle("velocity")),
      displacement(fields.handle("displacement")),
      stress(fields.handle("stress")),
      mass(fields.handle("mass")),
      volume(fields.handle("volume")),
      deviatoric_strain(fields.handle("deviatoric_strain")),
      material(fields.template handle<PetscInt>("material")) {
  if (fields.has("velocity_gradient")) velocity_gradient = fields.handle("velocity_gradient");
  if (fields.has("extent")) extent = fields.handle("extent");
}

template <int dim>
ParticleView<dim>::ParticleView(const Swarm<dim>& swarm, const FieldTable<dim>& fields,
                                const MemberHandles<dim>& members)
    : count(swarm.local_count()), rank(swarm.communicator().rank()), m_open(swarm.dm()) {
  m_data.reserve(fields.columns().size());
  for (const auto& column : fields.columns()) m_data.push_back(m_open.open(column.name));
  id = static_cast<std::int64_t*>(m_open.open(id_column));
  point_to(members.position, position);
  point_to(members.velocity, velocity);
  point_to(members.displacement, displacement);
  point_to(members.stress, std::span(stress).first(tensor_components<dim>));
  mass = (*this)[members.mass];
  volume = (*this)[members.volume];
  deviatoric_strain = (*this)[members.deviatoric_strain];
  material = (*this)[members.material];
  if (members.extent) point_to(*members.extent, std::span(extent).first(tensor_components<dim>));
  if (members.velocity_gradient)
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        velocity_gradient[i][j] = column(*members.velocity_gradient, dim * i + j);
}

template <int dim>
void ParticleView<dim>::point_to(StateHandle handle, std::span<double*> components) {
  int k = 0;
  for (double*& component : components) component = column(handle, k++);
}

template <int dim>
Particles<dim>::Particles(grid::Grid<dim>& grid, Materials materials, OptionalColumns optional)
    : m_grid(grid),
      m_materials(std::move(materials)),
      m_fields(m_materials, optional),
      m_members(m_fields),
      m_swarm(grid, "particle", m_fields.columns()),
      m_ranges(m_materials.size()) {}

template <int dim>
void Particles<dim>::fill(const Seed<dim>& seed, const ParticleView<dim>& view, int p) const {
  const material::Material& law = *m_materials[static_cast<std::size_t>(seed.material)];
  m_fields.set_initial(view, p);
  for (int d = 0; d < dim; ++d) {
    view.position[d][p] = seed.position[d];
    view.velocity[d][p] = seed.velocity[d];
  }
  view.mass[p] = seed.volume * law.initial_density();
  view.volume[p] = seed.volume;
  const double half = 0.5 * std::pow(seed.volume, 1.0 / dim);
  if (view.extent[0] != nullptr)
    for (int d = 0; d < dim; ++d) view.extent[static_cast<std::size_t>(d)][p] = half * half;
  view.id[p] = seed.id;
  view.material[p] = seed.material;
  const auto variables = law.state_variables();
  const auto states = m_fields.states(seed.material);
  for (std::size_t s = 0; s < states.size(); ++s) view[states[s]][p] = variables[s].initial;
}

template <int dim>
StateHandle Particles<dim>::state(int material, std::string_view name) const {
  const material::Material& law = *m_materials[static_cast<std::size_t>(material)];
  const auto variables = law.state_variables();
  const auto found = std::ranges::find(variables, name, &material::StateVariable::name);
  if (found == variables.end())
    throw BadInput(fmt::format("law '{}' of material {} has no state variable '{}'; it has {}",
                               law.name(), material, name, names(variables)));
  return m_fields.states(material)[static_cast<std::size_t>(found - variables.begin())];
}

template <int dim>
void Particles<dim>::add(std::span<const Seed<dim>> seeds) {
  const int first = m_swarm.grow(static_cast<int>(seeds.size()));
  {
    const ParticleView<dim> particles = view();
    for (std::size_t k = 0; k < seeds.size(); ++k)
      fill(seeds[k], particles, first + static_cast<int>(k));
  }
  sort();
}

template <int dim>
void Particles<dim>::migrate() {
  const petsc::Phase phase("mpm: migrate");
  m_swarm.migrate(cells());
  sort();
}

template <int dim>
std::vector<std::array<int, dim>> Particles<dim>::cells() const {
  const ParticleView<dim> particles = view();
  std::vector<std::array<int, dim>> cells;
  for (int p = 0; p < particles.count; ++p)
    cells.push_back(m_grid.cell_of(particles.position_of(p)));
  return cells;
}

/// Material-major, then row-major cell within this rank's reachable cells.
template <int dim>
std::vector<int> Particles<dim>::sort_keys(const ParticleView<dim>& particles) const {
  const grid::Box<dim>& cells = m_grid.reachable_cells().box();
  std::vector<int> keys(static_cast<std::size_t>(particles.count));
  for (int p = 0; p < particles.count; ++p) {
    const auto cell = m_grid.cell_of(particles.position_of(p));
    keys[static_cast<std::size_t>(p)] =
        static_cast<int>(particles.material[p]) * cells.size() + cells.index_of(cell);
  }
  return keys;
}

/// The box of cells with particles of all ranks, and so much around it that they rarely leave it.
template <int dim>
void Particles<dim>::renew_active_cells() const {
  constexpr int margin = 2;
  const grid::Box<dim> all = m_grid.all_cells();
  std::array<int, 2 * dim> extremes;  // first cells and, negative, last ones
  for (int d = 0; d < dim; ++d) extremes[d] = all.end[d], extremes[dim + d] = 0;
  for (const auto& cell : cells())
    for (int d = 0; d < dim; ++d) {
      extremes[d] = std::min(extremes[d], cell[d]);
      extremes[dim + d] = std::min(extremes[dim + d], -cell[d]);
    }
  communicator().minimum(extremes);
  grid::Box<dim> active;
  for (int d = 0; d < dim; ++d) {
    active.begin[d] = extremes[d] - margin;
    active.end[d] = 1 - extremes[dim + d] + margin;
  }
  m_grid.set_active_cells(grid::intersection(active, all));
}

template <int dim>
partition::CellWork<dim> Particles<dim>::count_in_cells() const {
  const grid::Box<dim> all = m_grid.all_cells();
  partition::CellWork<dim> counts{all.end,
                                  std::vector<double>(static_cast<std::size_t>(all.size()))};
  for (const auto& cell : cells())
    if (all.contains(cell)) counts.work[static_cast<std::size_t>(all.index_of(cell))] += 1.0;
  communicator().sum(counts.work);
  return counts;
}

template <int dim>
void Particles<dim>::sort() {
  const petsc::Phase phase("mpm: sort");
  ++m_order;
  renew_active_cells();
  const int keys_per_material = m_grid.reachable_cells().box().size();
  const auto materials = static_cast<int>(m_materials.size());
  std::vector<int> order;
  std::vector<int> first(static_cast<std::size_t>(keys_per_material * materials) + 1, 0);
  {
    const ParticleView<dim> particles = view();
    const std::vector<int> keys = sort_keys(particles);
    for (int key : keys) ++first[static_cast<std::size_t>(key) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<int> next = first;
    order.resize(keys.size());
    for (std::size_t p = 0; p < keys.size(); ++p)
      order[static_cast<std::size_t>(next[static_cast<std::size_t>(keys[p])]++)] =
          static_cast<int>(p);
  }
  m_swarm.permute(order);
  for (int k = 0; k < materials; ++k)
    m_ranges[static_cast<std::size_t>(k)] = {
        first[static_cast<std::size_t>(k * keys_per_material)],
        first[static_cast<std::size_t>((k + 1) * keys_per_material)]};
}

template <int dim>
void Particles<dim>::keep_order() {
  ++m_order;
  const ParticleView<dim> particles = view();
  const std::span<const PetscInt> materials(particles.material,
                                            static_cast<std::size_t>(particles.count));
  const auto known = static_cast<PetscInt>(m_materials.size());
  const auto is_known = [=](PetscInt k) { return k >= 0 && k < known; };
  if (!std::ranges::is_sorted(materials) || !std::ranges::all_of(materials, is_known))
    throw BadInput("has particles that are not sorted by the materials of the problem");
  for (PetscInt k = 0; k < known; ++k) {
    const auto alike = std::ranges::equal_range(materials, k);
    const auto first = static_cast<int>(alike.data() - materials.data());
    m_ranges[static_cast<std::size_t>(k)] = {first, first + static_cast<int>(alike.size())};
  }
}

template <int dim>
material::Batch Particles<dim>::batch_of(const ParticleView<dim>& particles, int material,
                                         const Range& range) const {
  material::Batch batch;
  batch.size = static_cast<std::size_t>(range.size());
  for (std::size_t k = 0; k < particles.stress.size(); ++k)
    if (particles.stress[k] != nullptr)
      batch.stress.component[k] = particles.stress[k] + range.first;
  for (const StateHandle state : m_fields.states(material))
    batch.state.push_back(particles[state] + range.first);
  return batch;
}

template struct MemberHandles<1>;
template struct MemberHandles<2>;
template struct MemberHandles<3>;
template class ParticleView<1>;
template class ParticleView<2>;
template class ParticleView<3>;
template class Particles<1>;
template class Particles<2>;
template class Particles<3>;

}  // namespace mpm::particles
