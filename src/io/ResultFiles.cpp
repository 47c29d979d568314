#include "mpm/io/ResultFiles.hpp"

#include <filesystem>
#include <fstream>
#include <system_error>

namespace mpm::io {
namespace {

/// A list that somebody has edited must not reach beyond its directory.
bool is_plain_name(const std::string& name) {
  return !name.empty() && name.find('/') == std::string::npos && name != "." && name != "..";
}

void remove_listed(const std::filesystem::path& directory) {
  std::ifstream list(directory / list_of_results);
  std::error_code ignored;  // a file that its user has removed is no fault
  for (std::string name; std::getline(list, name);) {
    if (!is_plain_name(name)) continue;
    std::filesystem::remove(directory / name, ignored);
    std::filesystem::remove(directory / (name + ".part"), ignored);
  }
  std::filesystem::remove(directory / list_of_results, ignored);
}

}  // namespace

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

void remove_results(const std::string& directory, const petsc::Communicator& communicator) {
  if (communicator.is_root()) remove_listed(directory);
  communicator.barrier();  // nobody writes before the old files are gone
}

}  // namespace mpm::io
