#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mpm::options {

/// Whether PETSc has an option of this name that acts on this program. Left out are those that
/// nothing here asks for (of matrices, vectors, solvers) and those that would bring in options
/// unchecked or change the grid.
bool is_petsc_option(std::string_view name);

std::vector<std::string> petsc_option_names();

/// What is wrong with the value of such an option, empty if nothing; PETSc itself would end the
/// program. `allowed` then says what is allowed.
std::string fault_of_petsc_value(std::string_view name, std::string_view value,
                                 std::string& allowed);

}  // namespace mpm::options
