#include "mpm/particles/Swarm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Error.hpp"

namespace mpm::particles {
namespace {

constexpr PetscInt spare_points = 1000;  // room for arrivals before the swarm reallocates

}  // namespace

OpenColumns::~OpenColumns() {
  for (auto& [name, data] : m_open)
    DMSwarmRestoreField(m_swarm, name.c_str(), nullptr, nullptr, &data);
}

void* OpenColumns::open(const std::string& name) {
  void* data = nullptr;
  MPM_PETSC(DMSwarmGetField(m_swarm, name.c_str(), nullptr, nullptr, &data));
  m_open.emplace_back(name, data);
  return data;
}

template <int dim>
Swarm<dim>::Swarm(const grid::Grid<dim>& grid, std::string what, std::span<const Column> columns)
    : m_grid(grid), m_what(std::move(what)) {
  MPM_PETSC(DMCreate(communicator(), m_swarm.address()));
  MPM_PETSC(DMSetType(m_swarm, DMSWARM));
  MPM_PETSC(DMSetDimension(m_swarm, dim));
  MPM_PETSC(DMSwarmSetType(m_swarm, DMSWARM_BASIC));
  MPM_PETSC(DMSwarmInitializeFieldRegister(m_swarm));
  for (const auto& [name, type] : columns) {
    const bool is_real = type == Type::real;
    MPM_PETSC(DMSwarmRegisterPetscDatatypeField(m_swarm, name.c_str(), 1,
                                                is_real ? PETSC_REAL : PETSC_INT));
    m_slots.push_back({name, is_real ? sizeof(PetscReal) : sizeof(PetscInt), type});
  }
  MPM_PETSC(DMSwarmFinalizeFieldRegister(m_swarm));
  m_slots.push_back({id_column, sizeof(std::int64_t)});  // registered by the swarm itself
  for (const Slot& slot : m_slots) m_bytes_per_point += slot.bytes;
  resize(0);
}

template <int dim>
void Swarm<dim>::resize(int count) {
  MPM_PETSC(DMSwarmSetLocalSizes(m_swarm, count, spare_points));
}

template <int dim>
int Swarm<dim>::local_count() const {
  PetscInt local = 0;
  MPM_PETSC(DMSwarmGetLocalSize(m_swarm, &local));
  return local;
}

template <int dim>
int Swarm<dim>::grow(int count) {
  const int before = local_count();
  resize(before + count);
  m_global_count += communicator().sum(static_cast<long long>(count));
  return before;
}

template <int dim>
void Swarm<dim>::replace(int count) {
  resize(count);
  m_global_count = communicator().sum(static_cast<long long>(count));
}

template <int dim>
std::vector<std::byte*> Swarm<dim>::open_slots(OpenColumns& open) const {
  std::vector<std::byte*> data;
  for (const Slot& slot : m_slots) data.push_back(static_cast<std::byte*>(open.open(slot.name)));
  return data;
}

/// -1 stands for a cell outside the grid.
template <int dim>
std::vector<int> Swarm<dim>::owners_of(std::span<const std::array<int, dim>> cells) const {
  std::vector<int> owners;
  for (const auto& cell : cells)
    owners.push_back(m_grid.all_cells().contains(cell) ? m_grid.rank_of_cell(cell) : -1);
  return owners;
}

template <int dim>
std::vector<std::byte> Swarm<dim>::pack(std::span<const int> leaving) const {
  std::vector<std::byte> data(leaving.size() * m_bytes_per_point);
  OpenColumns open(m_swarm);
  const std::vector<std::byte*> columns = open_slots(open);
  std::byte* out = data.data();
  for (int p : leaving)
    for (std::size_t c = 0; c < columns.size(); out += m_slots[c++].bytes)
      std::memcpy(out, columns[c] + static_cast<std::size_t>(p) * m_slots[c].bytes,
                  m_slots[c].bytes);
  return data;
}

template <int dim>
void Swarm<dim>::unpack(std::span<const std::byte> data, int first) {
  OpenColumns open(m_swarm);
  const std::vector<std::byte*> columns = open_slots(open);
  const std::byte* in = data.data();
  const std::size_t end = static_cast<std::size_t>(first) + data.size() / m_bytes_per_point;
  for (auto p = static_cast<std::size_t>(first); p < end; ++p)
    for (std::size_t c = 0; c < columns.size(); in += m_slots[c++].bytes)
      std::memcpy(columns[c] + p * m_slots[c].bytes, in, m_slots[c].bytes);
}

/// Closes the gaps that leaving points make. `leaving` is ascending.
template <int dim>
void Swarm<dim>::remove(std::span<const int> leaving) {
  std::vector<bool> stays(static_cast<std::size_t>(local_count()), true);
  for (int p : leaving) stays[static_cast<std::size_t>(p)] = false;
  std::vector<int> order;
  for (std::size_t p = 0; p < stays.size(); ++p)
    if (stays[p]) order.push_back(static_cast<int>(p));
  permute(order);
  resize(static_cast<int>(order.size()));
}

template <int dim>
void Swarm<dim>::permute(std::span<const int> order) {
  OpenColumns open(m_swarm);
  const std::vector<std::byte*> columns = open_slots(open);
  std::vector<std::byte> copy;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t bytes = m_slots[c].bytes;
    copy.resize(order.size() * bytes);
    for (std::size_t k = 0; k < order.size(); ++k)
      std::memcpy(copy.data() + k * bytes, columns[c] + static_cast<std::size_t>(order[k]) * bytes,
                  bytes);
    std::ranges::copy(copy, columns[c]);
  }
}

template <int dim>
void Swarm<dim>::migrate(std::span<const std::array<int, dim>> cells) {
  const std::vector<int> destination = owners_of(cells);
  const long long outside = std::count(destination.begin(), destination.end(), -1);
  if (communicator().sum(outside) > 0)
    throw NumericalFailure(fmt::format("a {} left the grid", m_what),
                           failure_kind("particle_lost", "a larger domain or a slower motion"));

  const int here = m_grid.rank();
  std::vector<int> leaving;
  for (int p = 0; p < static_cast<int>(destination.size()); ++p)
    if (destination[static_cast<std::size_t>(p)] != here) leaving.push_back(p);
  const std::vector<std::byte> incoming = exchange(leaving, destination);

  remove(leaving);
  const int staying = local_count();
  const int arriving = static_cast<int>(incoming.size() / m_bytes_per_point);
  resize(staying + arriving);
  unpack(incoming, staying);
  const long long count = communicator().sum(static_cast<long long>(staying + arriving));
  if (count != m_global_count)
    throw NumericalFailure(
        fmt::format("{} {}s before migration, {} after it", m_global_count, m_what, count));
}

/// Sends the leaving points to their destinations; returns those that arrive here.
template <int dim>
std::vector<std::byte> Swarm<dim>::exchange(std::span<const int> leaving,
                                            std::span<const int> destination) const {
  std::vector<int> by_rank(leaving.begin(), leaving.end());
  std::stable_sort(by_rank.begin(), by_rank.end(), [&](int p, int q) {
    return destination[static_cast<std::size_t>(p)] < destination[static_cast<std::size_t>(q)];
  });
  const auto bytes = static_cast<int>(m_bytes_per_point);
  std::vector<int> send_count(static_cast<std::size_t>(communicator().size()), 0);
  std::vector<int> receive_count = send_count, send_start = send_count, receive_start = send_count;
  for (int p : by_rank)
    send_count[static_cast<std::size_t>(destination[static_cast<std::size_t>(p)])] += bytes;
  MPI_Alltoall(send_count.data(), 1, MPI_INT, receive_count.data(), 1, MPI_INT, communicator());
  std::exclusive_scan(send_count.begin(), send_count.end(), send_start.begin(), 0);
  std::exclusive_scan(receive_count.begin(), receive_count.end(), receive_start.begin(), 0);

  const std::vector<std::byte> outgoing = pack(by_rank);
  std::vector<std::byte> incoming(
      static_cast<std::size_t>(receive_start.back() + receive_count.back()));
  MPI_Alltoallv(outgoing.data(), send_count.data(), send_start.data(), MPI_BYTE, incoming.data(),
                receive_count.data(), receive_start.data(), MPI_BYTE, communicator());
  return incoming;
}

template class Swarm<1>;
template class Swarm<2>;
template class Swarm<3>;

}  // namespace mpm::particles
