#include "mpm/io/ResultFiles.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace mpm::io {
namespace {

constexpr std::string_view unfinished = ".part";

constexpr std::array files{
    ResultFile{"used.opts", "options that reproduce the run"},
    ResultFile{"history.csv", "a row per output time"},
    ResultFile{"summary.json", "the answers above, when the run has finished"},
    ResultFile{"failure.json", "what is known of a numerical failure, in place of a summary"},
    ResultFile{"particles_*.h5", "the particles at an output time"},
    ResultFile{"particles.xdmf", "opens them in ParaView, as a series in time"},
    ResultFile{"grid_*.h5", "the nodes of the grid at an output time"},
    ResultFile{"grid.xdmf", "opens them in ParaView"},
    ResultFile{"checkpoint.h5", "all that a run needs to go on: see docs/restart.md"},
    ResultFile{"threshold.csv", "pipe: the slope of the curve and the failure threshold in it"},
    ResultFile{"pressure.csv", "hertz: contact pressure along the surface, by nodes"},
    ResultFile{"pressure_particles.csv", "hertz: the same by particles"},
};

bool are_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

bool is_called(std::string_view name, std::string_view pattern) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return name == pattern;
  const std::string_view head = pattern.substr(0, star), tail = pattern.substr(star + 1);
  return name.size() > head.size() + tail.size() && name.starts_with(head) &&
         name.ends_with(tail) &&
         are_digits(name.substr(star, name.size() - head.size() - tail.size()));
}

}  // namespace

std::span<const ResultFile> result_files() {
  return files;
}

bool is_result_name(std::string_view name) {
  if (name.ends_with(unfinished)) name.remove_suffix(unfinished.size());
  return std::ranges::any_of(files,
                             [name](const auto& file) { return is_called(name, file.name); });
}

bool register_result(const std::string& path) {
  const std::filesystem::path file(path);
  if (std::filesystem::exists(file)) return true;
  std::ofstream list(file.parent_path() / list_of_results, std::ios::app);
  list << file.filename().string() << '\n';
  return static_cast<bool>(list.flush());
}

void remove_result(const std::string& path) {
  std::error_code ignored;  // a file that its user has removed is no fault
  std::filesystem::remove(path, ignored);
}

}  // namespace mpm::io
