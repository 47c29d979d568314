#include "mpm/options/InputFile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "mpm/core/Errors.hpp"
#include "mpm/options/Characters.hpp"
#include "mpm/options/Range.hpp"

namespace mpm::options {
namespace {

constexpr std::size_t largest_file = 1 << 24;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Why a file is not to be seen.
std::string fault_of_absence(const std::string& path, const std::error_code& error) {
  std::error_code ignored;  // told by the words
  if (error && error != std::errc::no_such_file_or_directory)
    return "cannot be opened: " + error.message();
  const bool is_link = std::filesystem::is_symlink(path, ignored);
  return is_link ? "is a link to a file that does not exist" : "does not exist";
}

std::vector<double> numbers_of(std::string line, const std::string& place) {
  line.resize(std::min(line.find('#'), line.size()));
  std::ranges::replace_if(
      line, [](char c) { return c == ',' || c == '\t' || c == '\r'; }, ' ');
  std::istringstream words(line);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const std::string fault = read(word, RealRange{}, numbers.emplace_back());
    if (!fault.empty())
      throw BadInput(fmt::format("{} has an entry '{}' that {}", place, shown(word), fault));
  }
  return numbers;
}

}  // namespace

std::string load_text(const std::string& path, std::size_t most_bytes, std::string& text) {
  const std::string bad_path = fault_of_path(path);
  if (path.empty()) return "needs a value";
  if (!bad_path.empty()) return bad_path;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return fault_of_absence(path, error);
  if (std::filesystem::is_directory(status)) return "is a directory";
  if (!std::filesystem::is_regular_file(status)) return "is a pipe or a device, not a file";

  std::ifstream stream(path, std::ios::binary);
  text.resize(most_bytes + 1);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.eof() && stream.gcount() == 0) return "cannot be read";
  text.resize(static_cast<std::size_t>(stream.gcount()));
  const std::string fault = fault_of_file_text(text);
  if (!fault.empty()) return fault;
  if (text.size() > most_bytes) return fmt::format("is larger than {} MiB", most_bytes >> 20);
  if (text.starts_with(byte_order_mark)) text.erase(0, byte_order_mark.size());
  return {};
}

std::string read_input_file(std::string_view option, const std::string& path) {
  std::string text;
  const std::string fault = load_text(path, largest_file, text);
  if (fault.empty()) return text;
  throw BadInput(
      fmt::format("-{} {} {}; allowed: a text file, its path relative to the working directory; "
                  "check the path",
                  option, shown(path), fault));
}

std::string_view without_byte_order_mark(std::string_view text) {
  return text.starts_with(byte_order_mark) ? text.substr(byte_order_mark.size()) : text;
}

std::vector<NumberLine> read_number_lines(std::string_view option, const std::string& path) {
  std::istringstream lines(read_input_file(option, path));
  std::vector<NumberLine> table;
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) {
    ++count;
    std::vector<double> numbers = numbers_of(line, fmt::format("-{} {}:{}", option, path, count));
    if (!numbers.empty()) table.push_back({count, std::move(numbers)});
  }
  return table;
}

}  // namespace mpm::options
