#include "mpm/particles/Particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "mpm/petsc/Log.hpp"

namespace mpm::particles {
namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
constexpr std::array<const char*, 6> tensor_names{"xx", "yy", "zz", "xy", "yz", "xz"};

std::string velocity_gradient_name(int i, int j) {
  return fmt::format("velocity_gradient_{}{}", axis_names[static_cast<std::size_t>(i)],
                     axis_names[static_cast<std::size_t>(j)]);
}

}  // namespace

template <int dim>
std::vector<std::string> column_names(const Field& field) {
  std::vector<std::string> names;
  if (field.shape == Field::Shape::scalar) return {field.name};
  const int count = field.shape == Field::Shape::vector ? dim : tensor_components<dim>;
  for (int k = 0; k < count; ++k)
    names.push_back(field.name + "_" +
                    (field.shape == Field::Shape::vector ? axis_names[k] : tensor_names[k]));
  return names;
}

template <int dim>
ParticleView<dim>::ParticleView(const Swarm<dim>& swarm, std::span<const std::string> state_names,
                                const OptionalColumns& optional)
    : count(swarm.local_count()), m_columns(swarm.dm()) {
  m_columns.open_vector("position", position);
  m_columns.open_vector("velocity", velocity);
  m_columns.open_vector("displacement", displacement);
  for (int k = 0; k < tensor_components<dim>; ++k)
    stress[k] = m_columns.reals(fmt::format("stress_{}", tensor_names[k]));
  mass = m_columns.reals("mass");
  volume = m_columns.reals("volume");
  deviatoric_strain = m_columns.reals("deviatoric_strain");
  id = static_cast<std::int64_t*>(m_columns.open("DMSwarm_pid"));
  material = static_cast<PetscInt*>(m_columns.open("material"));
  for (const std::string& name : state_names) state.push_back(m_columns.reals(name));
  if (optional.velocity_gradient)
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        velocity_gradient[i][j] = m_columns.reals(velocity_gradient_name(i, j));
}

template <int dim>
Particles<dim>::Particles(grid::Grid<dim>& grid, Materials materials, OptionalColumns optional)
    : m_grid(grid),
      m_materials(std::move(materials)),
      m_optional(optional),
      m_swarm(grid, "particle", declare_fields()),
      m_ranges(m_materials.size()) {}

/// Fills the lists of fields and states; returns the columns that hold them.
template <int dim>
std::vector<typename Swarm<dim>::Column> Particles<dim>::declare_fields() {
  using Shape = Field::Shape;
  m_fields = {{"position", "position", "m", Shape::vector},
              {"velocity", "velocity", "m/s", Shape::vector},
              {"displacement", "displacement since the start of loading", "m", Shape::vector},
              {"stress", "Cauchy stress, tension positive", "Pa", Shape::tensor},
              {"mass", "mass", "kg", Shape::scalar},
              {"volume", "volume", "m^3", Shape::scalar},
              {"deviatoric_strain", "accumulated deviatoric strain", "1", Shape::scalar}};
  m_state_of_material.resize(m_materials.size());
  for (std::size_t k = 0; k < m_materials.size(); ++k)
    for (const material::StateVariable& variable : m_materials[k]->state_variables()) {
      auto found = std::find(m_state_names.begin(), m_state_names.end(), variable.name);
      m_state_of_material[k].push_back(
          static_cast<std::size_t>(std::distance(m_state_names.begin(), found)));
      if (found != m_state_names.end()) continue;
      m_state_names.push_back(variable.name);
      m_fields.push_back({variable.name, variable.long_name, variable.unit, Shape::scalar});
    }
  using Type = typename Swarm<dim>::Type;
  std::vector<typename Swarm<dim>::Column> columns;
  for (const Field& field : m_fields)
    for (const std::string& name : column_names<dim>(field)) columns.push_back({name, Type::real});
  columns.push_back({"material", Type::integer});
  if (m_optional.velocity_gradient)
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) columns.push_back({velocity_gradient_name(i, j), Type::real});
  return columns;
}

template <int dim>
void Particles<dim>::fill(const Seed<dim>& seed, const ParticleView<dim>& view, int p) const {
  const auto k = static_cast<std::size_t>(seed.material);
  for (int d = 0; d < dim; ++d) {
    view.position[d][p] = seed.position[d];
    view.velocity[d][p] = seed.velocity[d];
    view.displacement[d][p] = 0.0;
  }
  for (int c = 0; c < tensor_components<dim>; ++c) view.stress[c][p] = 0.0;
  view.mass[p] = seed.volume * m_materials[k]->initial_density();
  view.volume[p] = seed.volume;
  view.deviatoric_strain[p] = 0.0;
  view.id[p] = seed.id;
  view.material[p] = seed.material;
  for (double* state : view.state) state[p] = 0.0;
  if (m_optional.velocity_gradient)
    for (const auto& row : view.velocity_gradient)
      for (double* component : row) component[p] = 0.0;
  const auto variables = m_materials[k]->state_variables();
  for (std::size_t s = 0; s < variables.size(); ++s)
    view.state[m_state_of_material[k][s]][p] = variables[s].initial;
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
  MPI_Allreduce(MPI_IN_PLACE, extremes.data(), 2 * dim, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
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
  MPI_Allreduce(MPI_IN_PLACE, counts.work.data(), all.size(), MPI_DOUBLE, MPI_SUM,
                PETSC_COMM_WORLD);
  return counts;
}

template <int dim>
void Particles<dim>::sort() {
  const petsc::Phase phase("mpm: sort");
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
material::Batch Particles<dim>::batch_of(const ParticleView<dim>& particles, int material,
                                         const Range& range) const {
  material::Batch batch;
  batch.size = static_cast<std::size_t>(range.size());
  for (std::size_t k = 0; k < particles.stress.size(); ++k)
    if (particles.stress[k] != nullptr)
      batch.stress.component[k] = particles.stress[k] + range.first;
  for (std::size_t s : m_state_of_material[static_cast<std::size_t>(material)])
    batch.state.push_back(particles.state[s] + range.first);
  return batch;
}

template class ParticleView<1>;
template class ParticleView<2>;
template class ParticleView<3>;
template class Particles<1>;
template class Particles<2>;
template class Particles<3>;
template std::vector<std::string> column_names<1>(const Field&);
template std::vector<std::string> column_names<2>(const Field&);
template std::vector<std::string> column_names<3>(const Field&);

}  // namespace mpm::particles
