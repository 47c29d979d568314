#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "mpm/cases/Case.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/options/OptionSet.hpp"

namespace {

/// One level down, so that the sections of a scene stand under its name.
std::string demote_headings(const std::string& markdown) {
  std::string text;
  for (std::size_t begin = 0; begin < markdown.size();) {
    const std::size_t end = std::min(markdown.find('\n', begin), markdown.size() - 1) + 1;
    if (markdown[begin] == '#') text += '#';
    text += markdown.substr(begin, end - begin);
    begin = end;
  }
  return text;
}

std::string section(const mpm::cases::CaseKind& kind) {
  const auto scene = kind.make();
  mpm::options::OptionSet options;
  scene->declare(options);
  return fmt::format("\n## -scene {}\n\n{}.\n\n{}", kind.name, kind.sentence,
                     demote_headings(options.markdown()));
}

using Values = std::vector<std::pair<std::string, std::string>>;

/// What -sand NAME alone sets.
Values values_of(const mpm::material::NamedSand& sand) {
  mpm::options::OptionSet options;
  mpm::material::SandFactory factory;
  factory.declare(options);
  const std::vector<mpm::options::Given> given{{"sand", std::string(sand.name), "here"}};
  options.assign(given);
  return options.values();
}

/// Options in which the named sands differ, a column a sand.
std::string table_of_sands() {
  std::string head = "| option |", line = "|---|", rows;
  std::vector<Values> columns;
  for (const auto& sand : mpm::material::named_sands()) {
    head += fmt::format(" `{}` |", sand.name);
    line += "---|";
    columns.push_back(values_of(sand));
  }
  for (std::size_t k = 1; k < columns[0].size(); ++k) {
    const auto same = [&](const Values& column) { return column[k] == columns[0][k]; };
    if (std::ranges::all_of(columns, same)) continue;
    rows += fmt::format("| `-{}` |", columns[0][k].first);
    for (const Values& column : columns)
      rows += fmt::format(" {} |", column[k].second.empty() ? "-" : column[k].second);
    rows += '\n';
  }
  std::string sentences;
  for (const auto& sand : mpm::material::named_sands())
    sentences += fmt::format("- `{}`: {}.\n", sand.name, sand.sentence);
  return fmt::format(
      "\n## Named sands\n\nWhat `-sand NAME` stands for, where they differ "
      "([sands.md](sands.md) says why; the void ratio is that of the same relative density):\n\n"
      "{}\n{}\n{}\n{}",
      sentences, head, line, rows);
}

}  // namespace

/// Prints docs/options.md from the declarations in the code.
int main() {
  fmt::print(
      "<!-- Written by tools/reference from the declarations in the code; do not edit. "
      "-->\n"
      "# Options\n\n"
      "    mpmsolve -scene NAME [-options_file FILE] [-option value ...]\n\n"
      "Only `-scene` is required. An options file holds the same words as the command line, `#` "
      "starts a comment, and the command line overrides the file. `-help` prints the options of a "
      "scene, `-scene list` the scenes, `-version` the version. Units are SI. Defaults differ "
      "between scenes; those below are what a run uses when nothing is given.\n\n"
      "| scene | what it is |\n|---|---|\n");
  for (const auto& kind : mpm::cases::case_kinds())
    fmt::print("| [{0}](#-scene-{0}) | {1} |\n", kind.name, kind.sentence);
  fmt::print("{}", table_of_sands());
  for (const auto& kind : mpm::cases::case_kinds()) fmt::print("{}", section(kind));
}
