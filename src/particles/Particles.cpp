#include "mpm/particles/Particles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <stdexcept>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Error.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::particles {
namespace {

constexpr std::array<const char*, 3> axis_names{"x", "y", "z"};
constexpr std::array<const char*, 6> tensor_names{"xx", "yy", "zz", "xy", "yz", "xz"};
constexpr PetscInt spare_particles = 1000;  // room for arrivals before the swarm reallocates

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
ParticleView<dim>::ParticleView(DM swarm, std::span<const std::string> state_names)
    : m_swarm(swarm) {
  PetscInt local = 0;
  MPM_PETSC(DMSwarmGetLocalSize(swarm, &local));
  count = local;
  for (int d = 0; d < dim; ++d) {
    position[d] = static_cast<double*>(open(fmt::format("position_{}", axis_names[d])));
    velocity[d] = static_cast<double*>(open(fmt::format("velocity_{}", axis_names[d])));
    displacement[d] = static_cast<double*>(open(fmt::format("displacement_{}", axis_names[d])));
  }
  for (int k = 0; k < tensor_components<dim>; ++k)
    stress[k] = static_cast<double*>(open(fmt::format("stress_{}", tensor_names[k])));
  mass = static_cast<double*>(open("mass"));
  volume = static_cast<double*>(open("volume"));
  deviatoric_strain = static_cast<double*>(open("deviatoric_strain"));
  id = static_cast<std::int64_t*>(open("DMSwarm_pid"));
  material = static_cast<PetscInt*>(open("material"));
  for (const std::string& name : state_names) state.push_back(static_cast<double*>(open(name)));
}

template <int dim>
ParticleView<dim>::~ParticleView() {
  for (auto& [name, data] : m_open)
    DMSwarmRestoreField(m_swarm, name.c_str(), nullptr, nullptr, &data);
}

template <int dim>
void* ParticleView<dim>::open(const std::string& name) {
  void* data = nullptr;
  MPM_PETSC(DMSwarmGetField(m_swarm, name.c_str(), nullptr, nullptr, &data));
  m_open.emplace_back(name, data);
  return data;
}

template <int dim>
Particles<dim>::Particles(const grid::Grid<dim>& grid, Materials materials)
    : m_grid(grid), m_materials(std::move(materials)), m_ranges(m_materials.size()) {
  declare_fields();
  register_fields();
}

template <int dim>
void Particles<dim>::declare_fields() {
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
}

template <int dim>
void Particles<dim>::register_column(const std::string& name, PetscDataType type) {
  MPM_PETSC(DMSwarmRegisterPetscDatatypeField(m_swarm, name.c_str(), 1, type));
  m_columns.push_back({name, type == PETSC_REAL ? sizeof(PetscReal) : sizeof(PetscInt)});
}

template <int dim>
void Particles<dim>::register_fields() {
  MPM_PETSC(DMCreate(PETSC_COMM_WORLD, m_swarm.address()));
  MPM_PETSC(DMSetType(m_swarm, DMSWARM));
  MPM_PETSC(DMSetDimension(m_swarm, dim));
  MPM_PETSC(DMSwarmSetType(m_swarm, DMSWARM_BASIC));
  MPM_PETSC(DMSwarmInitializeFieldRegister(m_swarm));
  for (const Field& field : m_fields)
    for (const std::string& name : column_names<dim>(field)) register_column(name, PETSC_REAL);
  register_column("material", PETSC_INT);
  MPM_PETSC(DMSwarmFinalizeFieldRegister(m_swarm));
  m_columns.push_back({"DMSwarm_pid", sizeof(std::int64_t)});  // registered by the swarm itself
  MPM_PETSC(DMSwarmSetLocalSizes(m_swarm, 0, spare_particles));
}

template <int dim>
int Particles<dim>::local_count() const {
  PetscInt local = 0;
  MPM_PETSC(DMSwarmGetLocalSize(m_swarm, &local));
  return local;
}

template <int dim>
std::size_t Particles<dim>::bytes_per_particle() const {
  std::size_t bytes = 0;
  for (const Column& column : m_columns) bytes += column.bytes;
  return bytes;
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
  const auto variables = m_materials[k]->state_variables();
  for (std::size_t s = 0; s < variables.size(); ++s)
    view.state[m_state_of_material[k][s]][p] = variables[s].initial;
}

template <int dim>
void Particles<dim>::add(std::span<const Seed<dim>> seeds) {
  const int before = local_count();
  const auto arriving = static_cast<PetscInt>(seeds.size());
  MPM_PETSC(DMSwarmSetLocalSizes(m_swarm, before + arriving, spare_particles));
  {
    const ParticleView<dim> particles = view();
    for (std::size_t k = 0; k < seeds.size(); ++k)
      fill(seeds[k], particles, before + static_cast<int>(k));
  }
  m_global_count += petsc::sum(static_cast<long long>(seeds.size()));
  sort();
}

template <int dim>
std::vector<std::byte*> Particles<dim>::open_columns() const {
  std::vector<std::byte*> columns;
  for (const Column& column : m_columns) {
    void* data = nullptr;
    MPM_PETSC(DMSwarmGetField(m_swarm, column.name.c_str(), nullptr, nullptr, &data));
    columns.push_back(static_cast<std::byte*>(data));
  }
  return columns;
}

template <int dim>
void Particles<dim>::close_columns(std::vector<std::byte*>& columns) const {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    void* data = columns[c];
    MPM_PETSC(DMSwarmRestoreField(m_swarm, m_columns[c].name.c_str(), nullptr, nullptr, &data));
  }
}

/// The owner of every particle's cell; -1 for one outside the grid.
template <int dim>
std::vector<int> Particles<dim>::destinations() const {
  const ParticleView<dim> particles = view();
  std::vector<int> destination(static_cast<std::size_t>(particles.count));
  for (int p = 0; p < particles.count; ++p) {
    const auto cell = m_grid.cell_of(particles.position_of(p));
    destination[static_cast<std::size_t>(p)] =
        m_grid.all_cells().contains(cell) ? m_grid.rank_of_cell(cell) : -1;
  }
  return destination;
}

template <int dim>
std::vector<std::byte> Particles<dim>::pack(std::span<const int> leaving) const {
  std::vector<std::byte> data(leaving.size() * bytes_per_particle());
  std::vector<std::byte*> columns = open_columns();
  std::byte* out = data.data();
  for (int p : leaving)
    for (std::size_t c = 0; c < columns.size(); ++c) {
      std::memcpy(out, columns[c] + static_cast<std::size_t>(p) * m_columns[c].bytes,
                  m_columns[c].bytes);
      out += m_columns[c].bytes;
    }
  close_columns(columns);
  return data;
}

template <int dim>
void Particles<dim>::unpack(std::span<const std::byte> data, int first) {
  std::vector<std::byte*> columns = open_columns();
  const std::byte* in = data.data();
  const std::size_t arriving = data.size() / bytes_per_particle();
  for (std::size_t k = 0; k < arriving; ++k)
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::size_t p = static_cast<std::size_t>(first) + k;
      std::memcpy(columns[c] + p * m_columns[c].bytes, in, m_columns[c].bytes);
      in += m_columns[c].bytes;
    }
  close_columns(columns);
}

/// Closes the gaps that leaving particles make. `leaving` is ascending.
template <int dim>
void Particles<dim>::remove(std::span<const int> leaving) {
  std::vector<bool> stays(static_cast<std::size_t>(local_count()), true);
  for (int p : leaving) stays[static_cast<std::size_t>(p)] = false;
  std::vector<int> order;
  for (std::size_t p = 0; p < stays.size(); ++p)
    if (stays[p]) order.push_back(static_cast<int>(p));
  permute(order);
  MPM_PETSC(DMSwarmSetLocalSizes(m_swarm, static_cast<PetscInt>(order.size()), spare_particles));
}

template <int dim>
void Particles<dim>::migrate() {
  const std::vector<int> destination = destinations();
  const long long outside = std::count(destination.begin(), destination.end(), -1);
  if (petsc::sum(outside) > 0) throw NumericalFailure("a particle left the grid");

  const int here = petsc::world_rank();
  std::vector<int> leaving;
  for (int p = 0; p < static_cast<int>(destination.size()); ++p)
    if (destination[static_cast<std::size_t>(p)] != here) leaving.push_back(p);
  const std::vector<std::byte> incoming = exchange(leaving, destination);

  remove(leaving);
  const int staying = local_count();
  const int arriving = static_cast<int>(incoming.size() / bytes_per_particle());
  MPM_PETSC(DMSwarmSetLocalSizes(m_swarm, staying + arriving, spare_particles));
  unpack(incoming, staying);
  const long long count = petsc::sum(static_cast<long long>(staying + arriving));
  if (count != m_global_count)
    throw NumericalFailure(
        fmt::format("{} particles before migration, {} after it", m_global_count, count));
  sort();
}

/// Sends the leaving particles to their destinations; returns those that arrive here.
template <int dim>
std::vector<std::byte> Particles<dim>::exchange(std::span<const int> leaving,
                                                std::span<const int> destination) const {
  std::vector<int> by_rank(leaving.begin(), leaving.end());
  std::stable_sort(by_rank.begin(), by_rank.end(), [&](int p, int q) {
    return destination[static_cast<std::size_t>(p)] < destination[static_cast<std::size_t>(q)];
  });
  const auto bytes = static_cast<int>(bytes_per_particle());
  std::vector<int> send_count(static_cast<std::size_t>(petsc::world_size()), 0);
  std::vector<int> receive_count = send_count, send_start = send_count, receive_start = send_count;
  for (int p : by_rank)
    send_count[static_cast<std::size_t>(destination[static_cast<std::size_t>(p)])] += bytes;
  MPI_Alltoall(send_count.data(), 1, MPI_INT, receive_count.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  std::exclusive_scan(send_count.begin(), send_count.end(), send_start.begin(), 0);
  std::exclusive_scan(receive_count.begin(), receive_count.end(), receive_start.begin(), 0);

  const std::vector<std::byte> outgoing = pack(by_rank);
  std::vector<std::byte> incoming(
      static_cast<std::size_t>(receive_start.back() + receive_count.back()));
  MPI_Alltoallv(outgoing.data(), send_count.data(), send_start.data(), MPI_BYTE, incoming.data(),
                receive_count.data(), receive_start.data(), MPI_BYTE, PETSC_COMM_WORLD);
  return incoming;
}

/// Material-major, then row-major cell within this rank's reachable cells.
template <int dim>
std::vector<int> Particles<dim>::sort_keys(const ParticleView<dim>& particles) const {
  const grid::Box<dim>& cells = m_grid.reachable_cells();
  std::vector<int> keys(static_cast<std::size_t>(particles.count));
  for (int p = 0; p < particles.count; ++p) {
    const auto cell = m_grid.cell_of(particles.position_of(p));
    keys[static_cast<std::size_t>(p)] = static_cast<int>(particles.material[p]) * cells.size() +
                                        grid::Grid<dim>::index_in(cells, cell);
  }
  return keys;
}

template <int dim>
void Particles<dim>::sort() {
  const int keys_per_material = m_grid.reachable_cells().size();
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
  permute(order);
  for (int k = 0; k < materials; ++k)
    m_ranges[static_cast<std::size_t>(k)] = {
        first[static_cast<std::size_t>(k * keys_per_material)],
        first[static_cast<std::size_t>((k + 1) * keys_per_material)]};
}

/// Moves particle order[k] to place k in every column; places beyond order.size() are left over.
template <int dim>
void Particles<dim>::permute(std::span<const int> order) {
  std::vector<std::byte*> columns = open_columns();
  std::vector<std::byte> copy;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t bytes = m_columns[c].bytes;
    copy.resize(order.size() * bytes);
    for (std::size_t k = 0; k < order.size(); ++k)
      std::memcpy(copy.data() + k * bytes, columns[c] + static_cast<std::size_t>(order[k]) * bytes,
                  bytes);
    std::ranges::copy(copy, columns[c]);
  }
  close_columns(columns);
}

template <int dim>
material::Batch Particles<dim>::batch_of(const ParticleView<dim>& particles, int material) const {
  const Range range = range_of(material);
  material::Batch batch;
  batch.size = static_cast<std::size_t>(range.last - range.first);
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
