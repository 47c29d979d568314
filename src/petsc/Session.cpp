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
/// checked, and not in used.opts, may change a run or end it. The files are left alone for the
/// sake of the first argument only, not of an option set before.
void keep_out_foreign_options() {
  for (const char* name : {"PETSC_OPTIONS", "PETSC_OPTIONS_YAML"}) unsetenv(name);
}

std::vector<std::string> arguments_of(
    const std::vector<std::pair<std::string, std::string>>& options) {
  std::vector<std::string> words{"mpmsolve", "-skip_petscrc"};
  for (const auto& [name, value] : options) {
    words.push_back(fmt::format("-{}", name));
    if (!value.empty()) words.push_back(value);
  }
  return words;
}

}  // namespace

Session::Session(const std::vector<std::pair<std::string, std::string>>& options) {
  PetscBool is_running = PETSC_FALSE;
  MPM_PETSC(PetscInitialized(&is_running));
  m_owns_petsc = is_running == PETSC_FALSE;
  if (m_owns_petsc) start(options);
  m_rank = world_rank();
  m_ranks = world_size();
}

void Session::start(const std::vector<std::pair<std::string, std::string>>& options) {
  keep_out_foreign_options();
  m_words = arguments_of(options);
  for (std::string& word : m_words) m_arguments.push_back(word.data());
  m_arguments.push_back(nullptr);
  auto count = static_cast<int>(m_words.size());
  char** arguments = m_arguments.data();
  MPM_PETSC(PetscInitialize(&count, &arguments, nullptr, nullptr));  // MPI too, unless it runs
  MPM_PETSC(PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr));
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
