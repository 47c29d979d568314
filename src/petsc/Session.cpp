#include "mpm/petsc/Session.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <stdexcept>

#include "mpm/petsc/Error.hpp"

namespace mpm::petsc {

void check(PetscErrorCode code, const char* call, const char* file, int line) {
  if (code == 0) return;
  const char* text = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(code, &text, &specific);
  throw std::runtime_error(fmt::format("{}:{}: {} failed: {} {}", file, line, call,
                                       text != nullptr ? text : "unknown error",
                                       specific != nullptr ? specific : ""));
}

namespace {

/// PETSc would read options from the environment and from files of the user: nothing that is not
/// checked, and not in used.opts, may change a run or end it.
void keep_out_foreign_options() {
  for (const char* name : {"PETSC_OPTIONS", "PETSC_OPTIONS_YAML"}) unsetenv(name);
  MPM_PETSC(PetscOptionsSetValue(nullptr, "-skip_petscrc", nullptr));
}

}  // namespace

Session::Session(const std::vector<std::pair<std::string, std::string>>& options) {
  PetscBool is_running = PETSC_FALSE;
  MPM_PETSC(PetscInitialized(&is_running));
  m_owns_petsc = is_running == PETSC_FALSE;
  if (m_owns_petsc) keep_out_foreign_options();
  for (const auto& [name, value] : options)
    MPM_PETSC(PetscOptionsSetValue(nullptr, ("-" + name).c_str(),
                                   value.empty() ? nullptr : value.c_str()));
  if (m_owns_petsc) {
    MPM_PETSC(PetscInitializeNoArguments());  // starts MPI, and ends it, unless it runs already
    MPM_PETSC(PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr));
  }
  m_rank = world_rank();
  m_ranks = world_size();
}

Session::~Session() {
  if (!m_owns_petsc) return;
  PetscPopErrorHandler();
  PetscFinalize();
}

Communicator world() {
  return PETSC_COMM_WORLD;
}

}  // namespace mpm::petsc
