#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "mpm/petsc/Session.hpp"

namespace mpm::io {

// All of these are collective over the ranks of the communicator; the first of them does the work.

/// Writes a file as `path.part` and renames it; all ranks learn of a failure and throw
/// NumericalFailure.
void write_text_file(const std::string& path, const std::string& text,
                     const petsc::Communicator& communicator = petsc::world());

/// A table of numbers, 17 digits each, written row by row.
class CsvFile {
 public:
  /// Replaces an older file.
  CsvFile(std::string path, const std::vector<std::string>& columns,
          const petsc::Communicator& communicator = petsc::world());
  ~CsvFile();
  CsvFile(const CsvFile&) = delete;
  CsvFile& operator=(const CsvFile&) = delete;

  /// A row that cannot be written stops all ranks.
  void row(const std::vector<double>& values);

 private:
  void check(bool ok) const;
  bool put(const std::string& line);

  std::string m_path;
  petsc::Communicator m_communicator;
  std::FILE* m_file = nullptr;
};

}  // namespace mpm::io
