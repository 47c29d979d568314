#pragma once

#include <string>

#include "mpm/core/Errors.hpp"

namespace mpm::options {

/// One option as given, with the place it came from for messages ("command line",
/// "input/pipe.opts:12").
struct Given {
  std::string name;   ///< without the leading dash
  std::string value;  ///< empty when none was given
  std::string origin;

  bool is_from_command_line() const { return origin == command_line; }
  static constexpr const char* command_line = "command line";
};

/// Why an option is not accepted. `fault` continues the sentence "-name value (origin) ...".
struct Refusal {
  Given given;
  std::string fault;    ///< "is out of range"
  std::string allowed;  ///< "real, 0 to 2"
  std::string remedy;   ///< "leave it out for the default 0.4"
};

/// The one form of every message about input:
/// "-courant 3 (command line) is out of range; allowed: real, 0 to 2; leave it out for ...".
BadInput bad_input(const Refusal& refusal);

}  // namespace mpm::options
