#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace mpm::io {

/// Makes a directory with its parents. Collective; throws BadInput on all ranks if it cannot.
void make_directory(const std::string& path);

/// Removes the results of an earlier run from a directory, and nothing else. Collective.
void remove_results(const std::string& directory);

/// Writes a file as `path.part` and renames it; rank 0 does it, all ranks learn of a failure and
/// throw NumericalFailure. Collective.
void write_text_file(const std::string& path, const std::string& text);

/// A table of numbers, 17 digits each, written row by row by rank 0.
class CsvFile {
 public:
  /// Collective; replaces an older file.
  CsvFile(std::string path, const std::vector<std::string>& columns);
  ~CsvFile();
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;

  /// Collective: a row that cannot be written stops all ranks.
  void row(const std::vector<double>& values);

 private:
  void check(bool ok) const;

  std::string m_path;
  std::FILE* m_file = nullptr;
};

}  // namespace mpm::io
