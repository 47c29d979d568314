#include "mpm/options/PetscOptions.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>

#include "mpm/options/Range.hpp"

namespace mpm::options {
namespace {

enum class Kind { flag, integer, text, log_view };

struct PetscOption {
  std::string_view name;
  Kind kind = Kind::flag;
};

/// Of PETSc 3.18. What else it has nothing in this program asks for, as -options_left tells.
constexpr std::array petsc_options{
    PetscOption{"check_pointer_intensity", Kind::integer},
    PetscOption{"checkfunctionlist"},
    PetscOption{"citations", Kind::text},
    PetscOption{"debug_terminal", Kind::text},
    PetscOption{"debugger_pause", Kind::integer},
    PetscOption{"debugger_ranks", Kind::text},
    PetscOption{"display", Kind::text},
    PetscOption{"error_output_none"},
    PetscOption{"error_output_stdout"},
    PetscOption{"fp_trap"},
    PetscOption{"get_total_flops"},
    PetscOption{"info", Kind::text},
    PetscOption{"info_exclude", Kind::text},
    PetscOption{"log_all"},
    PetscOption{"log_exclude", Kind::text},
    PetscOption{"log_sync"},
    PetscOption{"log_trace", Kind::text},
    PetscOption{"log_view", Kind::log_view},
    PetscOption{"log_view_memory"},
    PetscOption{"malloc"},
    PetscOption{"malloc_coalesce"},
    PetscOption{"malloc_debug"},
    PetscOption{"malloc_dump"},
    PetscOption{"malloc_requested_size"},
    PetscOption{"malloc_test"},
    PetscOption{"malloc_view", Kind::text},
    PetscOption{"malloc_view_threshold", Kind::integer},
    PetscOption{"memory_view"},
    PetscOption{"mpi_return_on_error"},
    PetscOption{"no_signal_handler"},
    PetscOption{"objects_dump"},
    PetscOption{"on_error_abort"},
    PetscOption{"on_error_attach_debugger", Kind::text},
    PetscOption{"on_error_mpiabort"},
    PetscOption{"options_left"},
    PetscOption{"options_suppress_deprecated_warnings"},
    PetscOption{"options_view"},
    PetscOption{"skip_petscrc"},
    PetscOption{"start_in_debugger", Kind::text},
    PetscOption{"stop_for_debugger"},
};

constexpr std::array flag_words{"true", "false", "yes", "no", "on", "off", "1", "0"};
constexpr std::array log_formats{"default",   "ascii_info", "ascii_info_detail",
                                 "ascii_csv", "ascii_xml",  "ascii_flamegraph"};

const PetscOption* find(std::string_view name) {
  const auto found = std::ranges::find(petsc_options, name, &PetscOption::name);
  return found == petsc_options.end() ? nullptr : &*found;
}

std::string fault_of_flag(std::string_view value) {
  std::string word(value);
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::ranges::find(flag_words, word) == flag_words.end() ? "is neither true nor false" : "";
}

/// The part of a list at this place, and the rest of it.
std::string_view next_part(std::string_view& list) {
  const std::size_t colon = std::min(list.find(':'), list.size());
  const std::string_view part = list.substr(0, colon);
  list.remove_prefix(std::min(colon + 1, list.size()));
  return part;
}

/// PETSc would write at the end of the run what it cannot open then.
std::string fault_of_log_view(std::string_view value) {
  const std::string_view type = next_part(value), file = next_part(value);
  const std::string_view format = next_part(value);
  if (!type.empty() && type != "ascii") return "has no colon before the name of its file";
  if (!format.empty() && std::ranges::find(log_formats, format) == log_formats.end())
    return "asks for a format that there is not";
  std::error_code ignored;  // what cannot be seen is not there
  const std::filesystem::path path(file);
  const auto parent = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(parent, ignored)) return "names a file in no directory";
  return std::filesystem::is_directory(path, ignored) ? "names a directory" : "";
}

}  // namespace

bool is_petsc_option(std::string_view name) {
  return find(name) != nullptr;
}

std::vector<std::string> petsc_option_names() {
  std::vector<std::string> names;
  for (const PetscOption& option : petsc_options) names.emplace_back(option.name);
  return names;
}

std::string fault_of_petsc_value(std::string_view name, std::string_view value,
                                 std::string& allowed) {
  const PetscOption& option = *find(name);
  if (option.kind == Kind::integer) {
    std::int64_t number = 0;
    allowed = "an integer from 0";
    return value.empty() ? "needs a value" : read(value, {0, 1'000'000'000}, number);
  }
  if (value.empty() || option.kind == Kind::text) return "";
  if (option.kind == Kind::flag) {
    allowed = "true, false, or no value";
    return fault_of_flag(value);
  }
  allowed =
      "no value, or :FILE:FORMAT in a directory that is there; formats are ascii_info_detail, "
      "ascii_csv, ascii_xml, ascii_flamegraph";
  return fault_of_log_view(value);
}

}  // namespace mpm::options
