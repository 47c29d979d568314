#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "mpm/cases/Case.hpp"
#include "mpm/options/CommandLine.hpp"

namespace {

constexpr char separator = '\x1f';

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> words(1);
  for (const char c : line)
    if (c == separator)
      words.emplace_back();
    else
      words.back() += c;
  return words;
}

/// What the program does with its arguments before it looks at a scene as a whole.
void read(const std::vector<std::string>& words) {
  std::vector<const char*> arguments;
  for (const std::string& word : words) arguments.push_back(word.c_str());
  mpm::options::CommandLine line = mpm::options::read_command_line(arguments);
  const std::string name = line.value_of("scene").value_or("");
  const auto kinds = mpm::cases::case_kinds();
  const auto kind = std::ranges::find(kinds, name, &mpm::cases::CaseKind::name);
  if (kind == kinds.end()) throw mpm::BadInput("there is no such scene");
  const auto scene = kind->make();
  mpm::options::OptionSet options{name};
  scene->declare(options);
  std::erase_if(line.own, [](const auto& given) { return given.name == "scene"; });
  options.assign(line.own);
}

std::string on_one_line(std::string text) {
  std::ranges::replace(text, '\n', separator);
  return text;
}

}  // namespace

/// Reads many command lines, one a line of standard input with words apart by the unit separator,
/// and prints for each what it is refused for, or an empty line.
int main() {
  for (std::string line; std::getline(std::cin, line);) {
    std::string message;
    try {
      read(split(line));
    } catch (const mpm::BadInput& error) {
      message = on_one_line(error.what());
    } catch (const std::exception& error) {
      message = "ERROR " + on_one_line(error.what());
    }
    std::cout << message << '\n';
  }
}
