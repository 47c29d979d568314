#pragma once

#include <petscsys.h>

namespace mpm::petsc {

/// Throws std::runtime_error with PETSc's own message if `code` is not zero.
void check(PetscErrorCode code, const char* call, const char* file, int line);

}  // namespace mpm::petsc

/// Calls PETSc and turns an error code into an exception.
#define MPM_PETSC(call) ::mpm::petsc::check((call), #call, __FILE__, __LINE__)
