#include <fmt/format.h>

#include <string>

#include "mpm/io/Vocabulary.hpp"

namespace {

/// Of a cell of a table, where a bar would end it.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

}  // namespace

/// Prints docs/results.md from the declarations in the code.
int main() {
  fmt::print(
      "<!-- Written by tools/reference from the declarations in the code; do not edit. -->\n"
      "# Answers of summary.json\n\n"
      "Every answer of a run is a top-level key of `summary.json`, and a key means one thing, "
      "whatever the case. `*` stands for any text. Units are SI; forces and energies are per metre "
      "in plane strain.\n");
  for (const auto& group : mpm::io::vocabulary()) {
    fmt::print("\n## {}\n\n| key | unit | what it is |\n|---|---|---|\n", group.title);
    for (const auto& answer : group.answers)
      fmt::print("| `{}` | {} | {} |\n", answer.key, answer.unit, cell(answer.sentence));
  }
}
