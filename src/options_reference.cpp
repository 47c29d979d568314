#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mpm/cases/Case.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/options/OptionSet.hpp"

namespace {

using mpm::options::Row;

struct SceneRows {
  std::string name, sentence;
  std::vector<Row> rows;
};

/// An option that several scenes declare alike, but for its default.
struct Shared {
  Row row;
  std::string home;                                           ///< section it is printed in
  std::vector<std::string> sections;                          ///< that declare it
  std::vector<std::pair<std::string, std::string>> initials;  ///< scene, default
};

/// Home of what several scenes have in sections of their own.
const std::string no_common_section = "In several scenes";

std::vector<SceneRows> rows_of_scenes() {
  std::vector<SceneRows> scenes;
  for (const auto& kind : mpm::cases::case_kinds()) {
    const auto scene = kind.make();
    mpm::options::OptionSet options;
    scene->declare(options);
    options.open_examples();
    scenes.push_back({std::string(kind.name), std::string(kind.sentence), options.rows()});
    for (Row& row : scenes.back().rows)
      if (row.initial == "out/" + scenes.back().name) row.initial = "out/SCENE";
  }
  return scenes;
}

bool alike(const Row& a, const Row& b) {
  return a.name == b.name && a.unit == b.unit && a.allowed == b.allowed &&
         a.sentence == b.sentence && a.source == b.source;
}

bool is_in_several(const std::string& section, const std::vector<SceneRows>& scenes) {
  return std::ranges::count_if(scenes, [&](const SceneRows& scene) {
           return std::ranges::find(scene.rows, section, &Row::section) != scene.rows.end();
         }) > 1;
}

void add(std::vector<Shared>& all, const Row& row, const std::string& scene) {
  auto place = std::ranges::find_if(all, [&](const Shared& s) { return alike(s.row, row); });
  if (place == all.end()) place = all.insert(all.end(), {row, {}, {}, {}});
  place->sections.push_back(row.section);
  place->initials.emplace_back(scene, row.initial);
}

std::string most_common_initial(const Shared& shared) {
  const auto count = [&](const std::string& initial) {
    return std::ranges::count_if(shared.initials,
                                 [&](const auto& i) { return i.second == initial; });
  };
  std::string best = shared.initials[0].second;
  for (const auto& [scene, initial] : shared.initials)
    if (count(initial) > count(best)) best = initial;
  return best;
}

std::vector<Shared> shared_of(const std::vector<SceneRows>& scenes) {
  std::vector<Shared> all;
  for (const SceneRows& scene : scenes)
    for (const Row& row : scene.rows) add(all, row, scene.name);
  std::erase_if(all, [](const Shared& s) { return s.initials.size() < 2; });
  for (Shared& shared : all) {
    const auto home = std::ranges::find_if(
        shared.sections, [&](const std::string& s) { return is_in_several(s, scenes); });
    shared.home = home == shared.sections.end() ? no_common_section : *home;
    shared.row.initial = most_common_initial(shared);
  }
  return all;
}

std::vector<std::string> homes_of(const std::vector<Shared>& all) {
  std::vector<std::string> homes;
  for (const Shared& shared : all)
    if (std::ranges::find(homes, shared.home) == homes.end()) homes.push_back(shared.home);
  return homes;
}

std::string line_of(const Row& row) {
  std::string line = "|";
  for (const auto& text :
       {"`-" + row.name + "`", row.initial, row.unit, row.allowed, row.sentence, row.source}) {
    line += ' ';
    for (const char c : text) line += c == '|' ? std::string("\\|") : std::string(1, c);
    line += " |";
  }
  return line + '\n';
}

const std::string table_head =
    "| option | default | unit | allowed | meaning | source |\n|---|---|---|---|---|---|\n";

/// Scenes whose default is not the one of the table, a line a default.
std::string other_defaults(const Shared& shared) {
  std::vector<std::pair<std::string, std::string>> lines;
  for (const auto& [scene, initial] : shared.initials) {
    if (initial == shared.row.initial) continue;
    const auto line =
        std::ranges::find_if(lines, [&](const auto& l) { return l.first == initial; });
    if (line == lines.end())
      lines.emplace_back(initial, scene);
    else
      line->second += ", " + scene;
  }
  std::string text;
  for (const auto& [initial, names] : lines)
    text += fmt::format("| `-{}` | {} | {} |\n", shared.row.name, names, initial);
  return text;
}

std::string shared_section(const std::string& home, const std::vector<Shared>& all) {
  std::string rows, others;
  for (const Shared& shared : all) {
    if (shared.home != home) continue;
    rows += line_of(shared.row);
    others += other_defaults(shared);
  }
  if (!others.empty())
    others = "\nOther defaults:\n\n| option | in scene | default |\n|---|---|---|\n" + others;
  return fmt::format("\n### {}\n\n{}{}{}", home, table_head, rows, others);
}

std::string anchor(std::string heading) {
  for (char& c : heading)
    if (c == ' ')
      c = '-';
    else if (c >= 'A' && c <= 'Z')
      c = static_cast<char>(c - 'A' + 'a');
  return heading;
}

/// Which options of a shared section a scene has: a link, and names unless it has all.
std::string link_to(const std::string& home, const std::string& scene,
                    const std::vector<Shared>& all) {
  std::string had, missing;
  for (const Shared& shared : all) {
    if (shared.home != home) continue;
    const bool has =
        std::ranges::any_of(shared.initials, [&](const auto& i) { return i.first == scene; });
    (has ? had : missing) += fmt::format(" `-{}`", shared.row.name);
  }
  if (had.empty()) return {};
  const std::string link = fmt::format("- [{}](#{})", home, anchor(home));
  if (missing.empty()) return link + '\n';
  return had.size() <= missing.size() ? fmt::format("{}:{} only\n", link, had)
                                      : fmt::format("{}, without{}\n", link, missing);
}

std::string own_sections(const SceneRows& scene, const std::vector<Shared>& all) {
  std::string text, section;
  for (const Row& row : scene.rows) {
    if (std::ranges::any_of(all, [&](const Shared& s) { return alike(s.row, row); })) continue;
    if (row.section != section)
      text += fmt::format("\n### {} ({})\n\n{}", row.section, scene.name, table_head);
    section = row.section;
    text += line_of(row);
  }
  return text;
}

std::string scene_section(const SceneRows& scene, const std::vector<Shared>& all) {
  std::string links;
  for (const std::string& home : homes_of(all)) links += link_to(home, scene.name, all);
  return fmt::format("\n## -scene {}\n\n{}.\n\nShared options:\n\n{}{}", scene.name, scene.sentence,
                     links, own_sections(scene, all));
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

/// An option for programs; ends that are not there are left out.
nlohmann::ordered_json as_json(const Row& row) {
  nlohmann::ordered_json entry{{"name", row.name},
                               {"kind", mpm::options::word_for(row.kind)},
                               {"initial", row.initial},
                               {"unit", row.unit},
                               {"allowed", row.allowed}};
  if (!row.words.empty()) entry["words"] = row.words;
  if (!row.range) return entry;
  const double largest = std::numeric_limits<double>::max();
  if (row.range->minimum != -largest) {
    entry["minimum"] = row.range->minimum;
    entry["open_minimum"] = row.range->open_minimum;
  }
  if (row.range->maximum != largest) {
    entry["maximum"] = row.range->maximum;
    entry["open_maximum"] = row.range->open_maximum;
  }
  return entry;
}

void print_json() {
  nlohmann::ordered_json scenes;
  for (const SceneRows& scene : rows_of_scenes())
    for (const Row& row : scene.rows) scenes[scene.name].push_back(as_json(row));
  fmt::print("{}\n", scenes.dump(1));
}

void print_page() {
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
  const auto scenes = rows_of_scenes();
  const auto shared = shared_of(scenes);
  fmt::print(
      "\n## Shared options\n\nDeclared alike by several scenes; the section of a scene says "
      "which it has. SCENE is the scene's name.\n");
  for (const auto& home : homes_of(shared)) fmt::print("{}", shared_section(home, shared));
  fmt::print("{}", table_of_sands());
  for (const auto& scene : scenes) fmt::print("{}", scene_section(scene, shared));
}

}  // namespace

/// Prints docs/options.md from the declarations in the code; with --json a table for programs.
int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "--json")
    print_json();
  else
    print_page();
}
