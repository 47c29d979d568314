#include "mpm/io/TextFile.hpp"

#include <fmt/format.h>

#include <utility>

#include "mpm/core/Errors.hpp"
#include "mpm/io/ResultFiles.hpp"

namespace mpm::io {
namespace {

[[noreturn]] void fail(const std::string& path) {
  throw NumericalFailure(fmt::format(
      "cannot write '{}': check that its directory can be written and is not full", path));
}

bool write_whole(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && written;
}

}  // namespace

void write_text_file(const std::string& path, const std::string& text,
                     const petsc::Communicator& communicator) {
  const std::string part = path + ".part";
  bool ok = true;
  if (communicator.is_root())
    ok = register_result(path) && write_whole(part, text) &&
         std::rename(part.c_str(), path.c_str()) == 0;
  if (!communicator.all(ok)) fail(path);
}

CsvFile::CsvFile(std::string path, const std::vector<std::string>& columns,
                 const petsc::Communicator& communicator)
    : m_path(std::move(path)), m_communicator(communicator) {
  if (communicator.is_root() && register_result(m_path)) m_file = std::fopen(m_path.c_str(), "w");
  check(!communicator.is_root() ||
        (m_file != nullptr &&
         std::fputs((fmt::format("{}\n", fmt::join(columns, ","))).c_str(), m_file) >= 0));
}

CsvFile::~CsvFile() {
  if (m_file != nullptr) std::fclose(m_file);
}

void CsvFile::check(bool ok) const {
  if (!m_communicator.all(ok)) fail(m_path);
}

void CsvFile::row(const std::vector<double>& values) {
  bool ok = true;
  if (m_file != nullptr) {
    const std::string line = fmt::format("{:.17g}\n", fmt::join(values, ","));
    ok = std::fputs(line.c_str(), m_file) >= 0 && std::fflush(m_file) == 0;
  }
  check(ok);
}

}  // namespace mpm::io
