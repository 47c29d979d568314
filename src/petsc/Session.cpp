#include "mpm/petsc/Session.hpp"

#include <fmt/format.h>

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

Session::Session(const std::vector<std::pair<std::string, std::string>>& options) {
  for (const auto& [name, value] : options)
    MPM_PETSC(PetscOptionsSetValue(nullptr, ("-" + name).c_str(),
                                   value.empty() ? nullptr : value.c_str()));
  MPM_PETSC(PetscInitializeNoArguments());
  MPM_PETSC(PetscPushErrorHandler(PetscIgnoreErrorHandler, nullptr));
  MPI_Comm_rank(PETSC_COMM_WORLD, &m_rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &m_ranks);
}

Session::~Session() {
  PetscPopErrorHandler();
  PetscFinalize();
}

int world_rank() {
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank;
}

int world_size() {
  int ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  return ranks;
}

namespace {
template <class Number>
Number reduce(Number value, MPI_Datatype type, MPI_Op operation) {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, type, operation, PETSC_COMM_WORLD);
  return value;
}
}  // namespace

double sum(double value) {
  return reduce(value, MPI_DOUBLE, MPI_SUM);
}
double minimum(double value) {
  return reduce(value, MPI_DOUBLE, MPI_MIN);
}
double maximum(double value) {
  return reduce(value, MPI_DOUBLE, MPI_MAX);
}
long long sum(long long value) {
  return reduce(value, MPI_LONG_LONG, MPI_SUM);
}

void broadcast(std::vector<int>& values) {
  auto size = static_cast<int>(values.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  values.resize(static_cast<std::size_t>(size));
  MPI_Bcast(values.data(), size, MPI_INT, 0, PETSC_COMM_WORLD);
}

}  // namespace mpm::petsc
