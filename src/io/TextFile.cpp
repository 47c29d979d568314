#include "mpm/io/TextFile.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "mpm/core/Errors.hpp"
#include "mpm/io/ResultFiles.hpp"

namespace mpm::io {
namespace {

/// Throws on all ranks where the first could not write, with what the system told it. Collective.
void check_written(bool ok, const std::string& path, const petsc::Communicator& communicator) {
  const int number = errno;
  if (communicator.all(ok)) return;
  const std::string cause = communicator.first_text(ok ? "" : std::strerror(number));
  throw NumericalFailure(
      fmt::format("cannot write '{}' ({}): check that its directory can be written and is not full",
                  path, cause),
      failure_kind("cannot_write", "a directory that can be written and is not full"));
}

/// Closing must not hide why writing failed.
bool write_whole(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  const bool written =
      std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
  const int number = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written) errno = number;
  return written && closed;
}

/// A file that could not be written leaves no part of it, which would only take room.
bool write_and_rename(const std::string& path, const std::string& text) {
  const std::string part = path + ".part";
  if (write_whole(part, text) && std::rename(part.c_str(), path.c_str()) == 0) return true;
  const int number = errno;
  std::remove(part.c_str());
  errno = number;
  return false;
}

}  // namespace

void write_text_file(const std::string& path, const std::string& text,
                     const petsc::Communicator& communicator) {
  const bool ok =
      !communicator.is_root() || (register_result(path) && write_and_rename(path, text));
  check_written(ok, path, communicator);
}

CsvFile::CsvFile(std::string path, const std::vector<std::string>& columns,
                 const petsc::Communicator& communicator)
    : m_path(std::move(path)), m_communicator(communicator) {
  if (communicator.is_root() && register_result(m_path)) m_file = std::fopen(m_path.c_str(), "w");
  check(!communicator.is_root() ||
        (m_file != nullptr && put(fmt::format("{}", fmt::join(columns, ",")))));
}

CsvFile::~CsvFile() {
  if (m_file != nullptr) std::fclose(m_file);
}

void CsvFile::check(bool ok) const {
  check_written(ok, m_path, m_communicator);
}

bool CsvFile::put(const std::string& line) {
  return std::fputs((line + "\n").c_str(), m_file) >= 0 && std::fflush(m_file) == 0;
}

void CsvFile::row(const std::vector<double>& values) {
  check(m_file == nullptr || put(fmt::format("{:.17g}", fmt::join(values, ","))));
}

}  // namespace mpm::io
