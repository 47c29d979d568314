#pragma once

#include <span>

#include "mpm/core/Errors.hpp"

namespace mpm::app {

/// The program: reads the command line, runs the scene, writes the summary, prints the answer.
/// All errors end here: one message from rank 0, the same exit code on all ranks. Collective.
ExitCode run_application(std::span<const char* const> arguments);

}  // namespace mpm::app
