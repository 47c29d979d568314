#pragma once

#include <petscdmswarm.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mpm/grid/Grid.hpp"
#include "mpm/petsc/Handle.hpp"

namespace mpm::particles {

/// The 64-bit column that every swarm has besides those it is given.
inline constexpr auto id_column = "DMSwarm_pid";

/// Columns of a swarm while they are in use. The swarm cannot change its size meanwhile.
class OpenColumns {
 public:
  explicit OpenColumns(DM swarm) : m_swarm(swarm) {}
  ~OpenColumns();
  OpenColumns(const OpenColumns&) = delete;
  OpenColumns& operator=(const OpenColumns&) = delete;

  void* open(const std::string& name);
  double* reals(const std::string& name) { return static_cast<double*>(open(name)); }

  /// position_x, position_y, ... of a vector.
  template <std::size_t dim>
  void open_vector(const std::string& name, std::array<double*, dim>& components) {
    for (std::size_t d = 0; d < dim; ++d) components[d] = reals(name + "_" + "xyz"[d]);
  }

 private:
  DM m_swarm;
  std::vector<std::pair<std::string, void*>> m_open;
};

/// Points that belong to the rank that owns their cell: a DMSwarm (BASIC) with one column per
/// scalar. What the cell of a point is, its user says.
template <int dim>
class Swarm {
 public:
  enum class Type { real, integer };
  struct Column {
    std::string name;
    Type type;
  };

  /// Collective. `grid` must outlive the swarm. Every point has an id_column besides.
  /// `what` is the name of a point in messages.
  Swarm(const grid::Grid<dim>& grid, std::string what, std::span<const Column> columns);

  DM dm() const { return m_swarm; }
  const petsc::Communicator& communicator() const { return m_grid.communicator(); }
  int local_count() const;
  long long global_count() const { return m_global_count; }
  std::size_t bytes_per_point() const { return m_bytes_per_point; }

  /// Makes room for so many more points on this rank; returns the index of the first. Collective.
  int grow(int count);

  /// Makes room for so many points on this rank in place of all that are there. Collective.
  void replace(int count);

  /// Visits what is known of the points, to save it or put it back: visit(name, span), a span of
  /// double, PetscInt or, for the id, std::int64_t. Local.
  template <class Visit>
  void for_each_column(const Visit& visit) const {
    OpenColumns open(m_swarm);
    const auto count = static_cast<std::size_t>(local_count());
    for (const Slot& slot : m_slots) {
      void* const data = open.open(slot.name);
      if (slot.name == id_column)
        visit(slot.name, std::span(static_cast<std::int64_t*>(data), count));
      else if (slot.type == Type::real)
        visit(slot.name, std::span(static_cast<double*>(data), count));
      else
        visit(slot.name, std::span(static_cast<PetscInt*>(data), count));
    }
  }

  /// Sends every point to the rank that owns its cell, cells[p] for point p. Throws
  /// NumericalFailure on all ranks if a cell lies outside the grid or a point got lost. Collective.
  void migrate(std::span<const std::array<int, dim>> cells);

  /// Moves point order[k] to place k in every column; places beyond order.size() are left over.
  void permute(std::span<const int> order);

 private:
  struct Slot {
    std::string name;
    std::size_t bytes;
    Type type = Type::integer;
  };

  std::vector<std::byte*> open_slots(OpenColumns& open) const;
  std::vector<int> owners_of(std::span<const std::array<int, dim>> cells) const;
  std::vector<std::byte> exchange(std::span<const int> leaving,
                                  std::span<const int> destination) const;
  std::vector<std::byte> pack(std::span<const int> leaving) const;
  void unpack(std::span<const std::byte> data, int first);
  void remove(std::span<const int> leaving);
  void resize(int count);

  const grid::Grid<dim>& m_grid;
  std::string m_what;
  std::vector<Slot> m_slots;
  std::size_t m_bytes_per_point = 0;
  petsc::DmHandle m_swarm;
  long long m_global_count = 0;
};

extern template class Swarm<1>;
extern template class Swarm<2>;
extern template class Swarm<3>;

}  // namespace mpm::particles
