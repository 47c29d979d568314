#pragma once

#include <petscsys.h>

#include <algorithm>
#include <vector>

#include "mpm/particles/Particles.hpp"

namespace mpm::test {

inline int world_rank() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

inline int world_size() {
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  return ranks;
}

/// While it lives every rank is a world of its own: what is built and run meanwhile is the serial
/// reference for the run on all ranks.
class SerialWorld {
 public:
  SerialWorld() : m_world(PETSC_COMM_WORLD) { PETSC_COMM_WORLD = PETSC_COMM_SELF; }
  ~SerialWorld() { PETSC_COMM_WORLD = m_world; }
  SerialWorld(const SerialWorld&) = delete;
  SerialWorld& operator=(const SerialWorld&) = delete;

 private:
  MPI_Comm m_world;
};

/// The values of all ranks, one rank after another, on every rank. Collective.
template <class Value>
std::vector<Value> of_all_ranks(const std::vector<Value>& mine) {
  const auto bytes = static_cast<int>(mine.size() * sizeof(Value));
  std::vector<int> sizes(static_cast<std::size_t>(world_size())), starts(sizes);
  MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, PETSC_COMM_WORLD);
  for (std::size_t r = 1; r < sizes.size(); ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::vector<Value> all(static_cast<std::size_t>(starts.back() + sizes.back()) / sizeof(Value));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE,
                 PETSC_COMM_WORLD);
  return all;
}

/// What a particle is at one moment.
template <int dim>
struct Snapshot {
  std::int64_t id;
  Vector<dim> start, position, velocity;
  std::array<double, tensor_components<dim>> stress;
  double volume;

  bool operator==(const Snapshot&) const = default;
};

/// The particles of all ranks by id, on every rank. Collective.
template <int dim>
std::vector<Snapshot<dim>> snapshots(const particles::Particles<dim>& particles) {
  std::vector<Snapshot<dim>> mine;
  {
    const auto view = particles.view();
    for (int p = 0; p < view.count; ++p) {
      Snapshot<dim> one{view.id[p],          {}, view.position_of(p),
                        view.velocity_of(p), {}, view.volume[p]};
      for (int d = 0; d < dim; ++d) one.start[d] = one.position[d] - view.displacement[d][p];
      for (int k = 0; k < tensor_components<dim>; ++k)
        one.stress[static_cast<std::size_t>(k)] = view.stress[k][p];
      mine.push_back(one);
    }
  }
  std::vector<Snapshot<dim>> all = of_all_ranks(mine);
  std::ranges::sort(all, {}, &Snapshot<dim>::id);
  return all;
}

}  // namespace mpm::test
