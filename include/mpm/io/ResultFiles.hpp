#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mpm::io {

/// A file that runs write; `*` in its name stands for the number of an output.
struct ResultFile {
  std::string_view name;
  std::string_view sentence;
};

/// Everything that a run may write into its directory: what a name there is taken for.
std::span<const ResultFile> result_files();

/// Whether a run writes files of this name, or writes them as `name.part` before they are whole.
bool is_result_name(std::string_view name);

/// The file in which a directory of results lists what runs wrote there, one name a line.
inline constexpr auto list_of_results = "result_files.txt";

/// Enters a file that is about to be written in the list of its directory, so that the next run
/// knows it for a result; a file that is there already stays what it is. For the rank that writes.
/// Returns whether the list could be written.
bool register_result(const std::string& path);

/// Removes a file that runs have written, if it is there, and leaves it in the list. For the rank
/// that writes.
void remove_result(const std::string& path);

}  // namespace mpm::io
