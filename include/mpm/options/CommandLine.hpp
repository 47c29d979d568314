#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mpm/options/Given.hpp"

namespace mpm::options {

/// What the command line and its options files ask for, each name once: later files override
/// earlier ones, the command line overrides files.
struct CommandLine {
  bool help = false;
  bool version = false;
  bool list_scenes = false;  ///< -scene list
  std::vector<Given> own;    ///< for OptionSet::assign; values may be missing (empty)
  std::vector<Given> petsc;  ///< for PETSc's options database; values may be missing (empty)

  /// The value of an own option, nothing when it is not given. Throws BadInput when it is given
  /// without one.
  std::optional<std::string> value_of(std::string_view name) const;
};

/// Reads argv without the program's name, and every `-options_file`. An options file has one
/// `-name value` a line; `#` at the start or after a blank begins a comment; double quotes hold
/// values with blanks. Throws BadInput: stray words, an option twice in one place with different
/// values, files that are missing, unreadable, not text or nested.
CommandLine read_command_line(std::span<const char* const> arguments);

/// A value as an options file has to write it: in double quotes where it needs them.
std::string as_written(std::string_view value);

/// Names that OptionSet cannot declare: PETSc's, -help, -version, -options_file.
bool is_reserved(std::string_view name);

}  // namespace mpm::options
