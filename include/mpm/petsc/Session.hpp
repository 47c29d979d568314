#pragma once

#include <petscsys.h>

#include <string>
#include <utility>
#include <vector>

#include "mpm/petsc/Communicator.hpp"

namespace mpm::petsc {

/// PETSc and MPI from construction to destruction, as far as the caller has not started them: what
/// runs already is left running, with the caller's own handler of PETSc's errors. What starts here
/// reads neither PETSC_OPTIONS nor .petscrc.
class Session {
 public:
  /// `options` are PETSc's own, names without the dash; they are for a PETSc that starts here.
  /// Collective over all processes.
  explicit Session(const std::vector<std::pair<std::string, std::string>>& options = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  int rank() const { return m_rank; }
  int ranks() const { return m_ranks; }

 private:
  void start(const std::vector<std::pair<std::string, std::string>>& options);

  std::vector<std::string> m_words;  ///< what PETSc is called with, and refers to
  std::vector<char*> m_arguments;
  bool m_owns_petsc = false;
  int m_rank = 0;
  int m_ranks = 1;
};

/// All processes, PETSC_COMM_WORLD: for programs. Whatever has a grid asks the grid.
Communicator world();

inline int world_rank() {
  return world().rank();
}
inline int world_size() {
  return world().size();
}
inline bool is_root() {
  return world().is_root();
}

/// Sum, minimum and maximum over all ranks of the world. Collective.
inline double sum(double value) {
  return world().sum(value);
}
inline double minimum(double value) {
  return world().minimum(value);
}
inline double maximum(double value) {
  return world().maximum(value);
}
inline long long sum(long long value) {
  return world().sum(value);
}

}  // namespace mpm::petsc
