#include "mpm/options/InputFile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "mpm/core/Errors.hpp"
#include "mpm/options/Range.hpp"

namespace mpm::options {
namespace {

constexpr std::uintmax_t largest_file = 1 << 24;
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

std::vector<double> numbers_of(std::string line, const std::string& place) {
  line.resize(std::min(line.find('#'), line.size()));
  std::ranges::replace_if(
      line, [](char c) { return c == ',' || c == '\t' || c == '\r'; }, ' ');
  std::istringstream words(line);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    const std::string fault = read(word, RealRange{}, numbers.emplace_back());
    if (!fault.empty())
      throw BadInput(fmt::format("{} has an entry '{}' that {}", place, word, fault));
  }
  return numbers;
}

}  // namespace

std::string read_input_file(std::string_view option, const std::string& path) {
  const auto refuse = [&](const char* why) {
    throw BadInput(
        fmt::format("-{} {} {}; allowed: a text file, its path relative to the working directory",
                    option, path, why));
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) refuse("is not a file");
  if (std::filesystem::file_size(path, error) > largest_file) refuse("is larger than 16 MB");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) refuse("cannot be read");
  if (text.str().find('\0') != std::string::npos) refuse("is not a text file");
  return std::string(without_byte_order_mark(text.str()));
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
