#include <fmt/format.h>

#include <string>

#include "mpm/io/ResultFiles.hpp"
#include "mpm/io/Vocabulary.hpp"

namespace {

/// Of a cell of a table, where a bar would end it.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

constexpr auto about_files =
    "\n## Files of a run\n\n"
    "All in `-output_dir`, `*` stands for the number of an output. What is being written has "
    "`.part` at the end of its name until it is whole.\n\n"
    "**What is replaced.** A run lists what it writes in `{0}`. The next run into the directory "
    "removes the files of that list, says how many, and nothing else: files of yours stay, "
    "options files and tables that the run itself reads among them. This happens when all input "
    "is accepted and the scene is set up; until then nothing is changed. A file with a name of "
    "the table that is not in the list is yours, and the run stops with exit code 2. So it does "
    "where it would read a file that it is to replace; `used.opts` as `-options_file` may be, and "
    "is written anew. A run that goes on (`-restart`) keeps what is there, see "
    "[restart.md](restart.md). Pictures stay until they are drawn again.\n\n"
    "**One run at a time.** A run holds `{0}` locked as long as it lives, and a second run into "
    "the directory stops with exit code 2. A killed run leaves no lock behind, and what it was "
    "writing is removed by the next one. Where the file system has no locks a line says so.\n\n"
    "| file | what it is |\n|---|---|\n";

void print_files() {
  fmt::print(fmt::runtime(about_files), mpm::io::list_of_results);
  for (const auto& file : mpm::io::result_files())
    fmt::print("| `{}` | {} |\n", file.name, cell(file.sentence));
  fmt::print("| `{}` | names of the files above that runs have written here |\n",
             mpm::io::list_of_results);
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
  print_files();
}
