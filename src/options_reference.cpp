#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "mpm/options/OptionSet.hpp"
#include "mpm/scene/Scene.hpp"

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

std::string section(const mpm::scene::SceneKind& kind) {
  const auto scene = kind.make();
  mpm::options::OptionSet options;
  scene->declare(options);
  return fmt::format("\n## -scene {}\n\n{}.\n\n{}", kind.name, kind.sentence,
                     demote_headings(options.markdown()));
}

}  // namespace

/// Prints docs/options.md from the declarations in the code.
int main() {
  fmt::print(
      "<!-- Written by tools/options_reference from the declarations in the code; do not edit. "
      "-->\n"
      "# Options\n\n"
      "    mpmsolve -scene NAME [-options_file FILE] [-option value ...]\n\n"
      "Only `-scene` is required. An options file holds the same words as the command line, `#` "
      "starts a comment, and the command line overrides the file. `-help` prints the options of a "
      "scene, `-scene list` the scenes, `-version` the version. Units are SI. Defaults differ "
      "between scenes; those below are what a run uses when nothing is given.\n\n"
      "| scene | what it is |\n|---|---|\n");
  for (const auto& kind : mpm::scene::scene_kinds())
    fmt::print("| [{0}](#-scene-{0}) | {1} |\n", kind.name, kind.sentence);
  for (const auto& kind : mpm::scene::scene_kinds()) fmt::print("{}", section(kind));
}
