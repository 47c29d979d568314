#pragma once

#include <petscsys.h>

#include <string>
#include <utility>
#include <vector>

namespace mpm::petsc {

/// PETSc and MPI from construction to destruction.
class Session {
 public:
  /// `options` are PETSc's own, names without the dash. Collective over all processes.
  explicit Session(const std::vector<std::pair<std::string, std::string>>& options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  int rank() const { return m_rank; }
  int ranks() const { return m_ranks; }

 private:
  int m_rank = 0;
  int m_ranks = 1;
};

/// Of the world.
int world_rank();
int world_size();
inline bool is_root() {
  return world_rank() == 0;
}

/// Sum, minimum and maximum over all ranks of the world. Collective; the order of summation
/// depends on the number of ranks only.
double sum(double value);
double minimum(double value);
double maximum(double value);
long long sum(long long value);

/// Makes the numbers of the first rank those of all. Collective.
void broadcast(std::vector<int>& values);

}  // namespace mpm::petsc
