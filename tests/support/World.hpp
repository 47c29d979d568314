#pragma once

#include <algorithm>
#include <vector>

#include "mpm/particles/Particles.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::test {

/// The ranks that a test builds its grids and setups on.
inline petsc::Communicator& world() {
  static petsc::Communicator current = petsc::world();
  return current;
}

inline int world_rank() {
  return world().rank();
}
inline int world_size() {
  return world().size();
}

/// While it lives the world of the tests is another one. Real sums of petsc:: go over all still.
class OtherWorld {
 public:
  explicit OtherWorld(const petsc::Communicator& other) : m_before(world()) { world() = other; }
  ~OtherWorld() { world() = m_before; }
  OtherWorld(const OtherWorld&) = delete;
  OtherWorld& operator=(const OtherWorld&) = delete;

 private:
  petsc::Communicator m_before;
};

/// Every rank is a world of its own: what is built and run meanwhile is the serial reference for
/// the run on all ranks.
class SerialWorld : public OtherWorld {
 public:
  SerialWorld() : OtherWorld(PETSC_COMM_SELF) {}
};

/// The values of all ranks, one rank after another, on every rank. Collective.
template <class Value>
std::vector<Value> of_all_ranks(const std::vector<Value>& mine,
                                const petsc::Communicator& communicator = world()) {
  const auto bytes = static_cast<int>(mine.size() * sizeof(Value));
  std::vector<int> sizes(static_cast<std::size_t>(communicator.size())), starts(sizes);
  MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, communicator);
  for (std::size_t r = 1; r < sizes.size(); ++r) starts[r] = starts[r - 1] + sizes[r - 1];
  std::vector<Value> all(static_cast<std::size_t>(starts.back() + sizes.back()) / sizeof(Value));
  MPI_Allgatherv(mine.data(), bytes, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE,
                 communicator);
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
  std::vector<Snapshot<dim>> all = of_all_ranks(mine, particles.communicator());
  std::ranges::sort(all, {}, &Snapshot<dim>::id);
  return all;
}

}  // namespace mpm::test
