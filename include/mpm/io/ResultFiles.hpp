#pragma once

#include <string>

#include "mpm/petsc/Session.hpp"

namespace mpm::io {

/// The file in which a directory of results lists what runs wrote there, one name a line.
inline constexpr auto list_of_results = "result_files.txt";

/// Enters a file that is about to be written in the list of its directory, so that the next run
/// knows it for a result; a file that is there already stays what it is. For the rank that writes.
/// Returns whether the list could be written.
bool register_result(const std::string& path);

/// Removes a file that runs have written, if it is there, and leaves it in the list. For the rank
/// that writes.
void remove_result(const std::string& path);

/// Removes the files that runs have listed in a directory, and nothing else. Collective.
void remove_results(const std::string& directory,
                    const petsc::Communicator& communicator = petsc::world());

}  // namespace mpm::io
