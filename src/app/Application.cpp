#include "mpm/app/Application.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "mpm/Version.hpp"
#include "mpm/cases/Case.hpp"
#include "mpm/io/Hdf5File.hpp"
#include "mpm/io/OutputDirectory.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/options/CommandLine.hpp"
#include "mpm/options/InputFile.hpp"
#include "mpm/options/Nearest.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/CheckpointOptions.hpp"
#include "mpm/run/Signals.hpp"

namespace mpm::app {
namespace {

using cases::Case;
using cases::case_kinds;
using cases::CaseKind;
using Clock = std::chrono::steady_clock;

std::vector<std::pair<std::string, std::string>> for_petsc(const options::CommandLine& line) {
  std::vector<std::pair<std::string, std::string>> options;
  for (const options::Given& given : line.petsc) options.emplace_back(given.name, given.value);
  return options;
}

std::string list_of_scenes() {
  std::string text;
  for (const CaseKind& kind : case_kinds())
    text += fmt::format("  {:<16} {}\n", kind.name, kind.sentence);
  return text;
}

std::string general_help() {
  return fmt::format(
      "mpmsolve {}: pipe-soil interaction by the B-spline material point method\n\n"
      "  mpirun -np 2 mpmsolve -options_file input/pipe.opts [-option value ...]\n"
      "  mpmsolve -scene NAME -help      options of a scene\n"
      "  mpmsolve -scene list | -version\n\nScenes:\n{}",
      version, list_of_scenes());
}

const CaseKind& find_scene(const std::string& name) {
  std::vector<std::string> names;
  for (const CaseKind& kind : case_kinds()) {
    if (kind.name == name) return kind;
    names.emplace_back(kind.name);
  }
  throw BadInput(fmt::format("-scene {}: there is no such scene; allowed are {}; the nearest is {}",
                             name, fmt::join(names, ", "), options::nearest(name, names)));
}

/// What failure.json holds: at least the message.
std::string as_json(const NumericalFailure& failure) {
  nlohmann::ordered_json details = nlohmann::ordered_json::parse(failure.details());
  if (!details.contains("message")) details["message"] = failure.what();
  return details.dump(2) + "\n";
}

class Root {
 public:
  explicit Root(bool is_root) : m_is_root(is_root) {}
  void print(const std::string& text) const { put(stdout, text); }
  void complain(const std::string& text) const { put(stderr, text); }

 private:
  void put(std::FILE* stream, const std::string& text) const {
    if (m_is_root) std::fputs(text.c_str(), stream);  // does not throw where nobody reads
    std::fflush(stream);
  }
  bool m_is_root;
};

/// Everything of a scene's options but the scene itself.
std::vector<options::Given> without_scene(const options::CommandLine& line) {
  std::vector<options::Given> rest;
  for (const options::Given& given : line.own)
    if (given.name != "scene") rest.push_back(given);
  return rest;
}

void print_summary(const Root& root, const Case& scene, const io::Summary& summary) {
  std::string text = "\n";
  for (const char* key : {"scene", "ranks", "cells", "particles", "steps", "particle_updates_per_s",
                          "peak_memory_bytes", "wall_s"})
    if (summary.has(key)) text += fmt::format("  {:<24} {}\n", key, summary.text(key));
  const bool is_withheld = summary.is_withheld();
  text += fmt::format("  {:<24} {}\n", "answer", is_withheld ? "withheld" : scene.answer(summary));
  for (const std::string& reason : summary.texts("answer_withheld"))
    text += fmt::format("  {:<24} {}\n", "contradicted", reason);
  for (const std::string& warning : summary.texts("warnings"))
    text += fmt::format("  {:<24} {}\n", "warning", warning);
  root.print(text + fmt::format("  {:<24} {}\n", "results in", scene.output_directory()));
}

/// How the run ended whose summary with these options is in the directory; nothing where there is
/// none. Collective.
std::optional<ExitCode> present_end(const std::string& directory,
                                    const options::OptionSet& options) {
  std::ifstream file(directory + "/summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  bool same = summary.is_object() && summary.value("scene", "") == options.title();
  io::Summary present;
  present.add_options(options);
  const auto wanted = nlohmann::json::parse(present.json());
  for (const auto& [name, value] : options.values()) {
    const std::string key = "option_" + name;
    if (!run::leaves_results_alone(name))
      same = same && summary.value(key, nlohmann::json()) == wanted[key];
  }
  if (!petsc::world().all(same)) return std::nullopt;
  return summary.contains("answer_withheld") ? ExitCode::answer_withheld : ExitCode::finished;
}

/// A file may be unreadable on some ranks only: all have to agree. Throws BadInput. Collective.
void check_input_files(const options::OptionSet& options) {
  std::string fault;
  try {
    for (const options::Given& file : options.input_files())
      options::read_input_file(file.name, file.value);
  } catch (const BadInput& error) {
    fault = error.what();
  }
  fault = petsc::world().first_text(fault);
  if (!fault.empty()) throw BadInput(fault);
}

/// Takes the directory for a run whose input is accepted.
void prepare_output(const Case& scene, io::OutputDirectory& directory, const Root& root) {
  if (scene.goes_on_in_place()) return directory.go_on();
  const std::size_t replaced = directory.begin_anew();
  if (replaced > 0)
    root.print(fmt::format("replaces {} {} of an earlier run in {}\n", replaced,
                           replaced == 1 ? "file" : "files", scene.output_directory()));
}

/// The directory, which nothing has been changed in yet. Throws BadInput.
std::unique_ptr<io::OutputDirectory> open_output(const options::OptionSet& options, bool goes_on,
                                                 const Root& root) {
  using Unlisted = io::OutputDirectory::Unlisted;
  auto directory = std::make_unique<io::OutputDirectory>(
      options.given("output_dir"), goes_on ? Unlisted::checkpoint : Unlisted::none);
  if (!directory->without_lock().empty())
    root.complain(fmt::format("mpmsolve: -output_dir {}: nothing keeps a second run out ({})\n",
                              options.given("output_dir").value, directory->without_lock()));
  for (const options::Given& file : options.input_files()) directory->check_input(file);
  return directory;
}

/// Without the good manners of MPI_Finalize.
void end_all_ranks(ExitCode code) {
  std::fflush(stdout);
  std::fflush(stderr);
  MPI_Abort(PETSC_COMM_WORLD, static_cast<int>(code));
}

/// The failure itself is told first: the disk may be full.
ExitCode report_failure(const Case& scene, const NumericalFailure& failure, const Root& root) {
  const std::string path = scene.output_directory() + "/failure.json";
  root.complain(fmt::format("mpmsolve: the run failed: {}\n", failure.what()));
  try {
    io::write_text_file(path, as_json(failure));
    root.complain(fmt::format("  details in {}\n", path));
  } catch (const NumericalFailure& second) {
    root.complain(fmt::format("  {}\n", second.what()));
  }
  if (io::Hdf5File::has_left_one_open()) end_all_ranks(ExitCode::numerical_failure);
  return ExitCode::numerical_failure;
}

/// Runs a scene that has its options.
ExitCode finish(Case& scene, const options::OptionSet& options, const Root& root,
                Clock::time_point begin) {
  io::Summary summary;
  summary.set("scene", options.title());
  summary.set("version", std::string(version));
  summary.set("git_hash", std::string(git_hash));
  for (const std::string& caution : options.cautions()) {
    root.complain(fmt::format("mpmsolve: warning: {}\n", caution));
    summary.warn(caution);
  }
  try {
    scene.run(summary);
  } catch (const NumericalFailure& failure) {
    return report_failure(scene, failure, root);
  } catch (const StoppedEarly& stop) {
    root.complain(
        fmt::format("mpmsolve: {}; the same command with -restart auto goes on\n", stop.what()));
    return ExitCode::stopped_early;
  }
  summary.add_options(options);
  summary.set("wall_s", std::chrono::duration<double>(Clock::now() - begin).count());
  summary.write(scene.output_directory());
  print_summary(root, scene, summary);
  return summary.is_withheld() ? ExitCode::answer_withheld : ExitCode::finished;
}

ExitCode run_scene(const options::CommandLine& line, const Root& root, Clock::time_point begin) {
  const auto name = line.value_of("scene");
  if (!name) throw BadInput(fmt::format("-scene is missing: name one of\n{}", list_of_scenes()));
  const CaseKind& kind = find_scene(*name);
  const std::unique_ptr<Case> scene = kind.make();
  options::OptionSet options{std::string(kind.name)};
  scene->declare(options);
  if (line.help) {
    options.open_examples();
    root.print(fmt::format("-scene {}: {}\n\n{}", kind.name, kind.sentence, options.help()));
    return ExitCode::finished;
  }
  options.assign(without_scene(line));
  const bool can_go_on = options.has("restart");
  const bool goes_on = can_go_on && options.is_changed("restart");
  const auto end = goes_on ? present_end(scene->output_directory(), options) : std::nullopt;
  if (end) {
    root.print(
        fmt::format("the run is finished, its results are in {}; leave -restart out to "
                    "compute it anew\n",
                    scene->output_directory()));
    return *end;
  }
  check_input_files(options);
  const auto directory = open_output(options, goes_on, root);
  std::optional<run::SignalHandlers> handlers;
  if (can_go_on) handlers.emplace();
  scene->prepare();
  prepare_output(*scene, *directory, root);
  io::write_text_file(scene->output_directory() + "/used.opts",
                      fmt::format("-scene {}\n{}", kind.name, options.used()));
  return finish(*scene, options, root, begin);
}

ExitCode answer(const options::CommandLine& line, const Root& root, Clock::time_point begin) {
  if (line.version) {
    root.print(fmt::format("mpmsolve {} ({})\n", version, git_hash));
  } else if (line.list_scenes) {
    root.print(list_of_scenes());
  } else if (line.help && !line.value_of("scene")) {
    root.print(general_help());
  } else {
    return run_scene(line, root, begin);
  }
  return ExitCode::finished;
}

}  // namespace

ExitCode run_application(std::span<const char* const> arguments) {
  const Clock::time_point begin = Clock::now();
  options::CommandLine line;
  std::optional<std::string> refused;
  try {
    line = options::read_command_line(arguments);
  } catch (const BadInput& error) {
    refused = error.what();
  }
  const bool has_petsc_options = std::getenv("PETSC_OPTIONS") != nullptr;
  const petsc::Session session(for_petsc(line));
  const Root root(session.rank() == 0);
  if (has_petsc_options)
    root.complain(
        "mpmsolve: PETSC_OPTIONS is not read; give options of PETSc on the command line\n");
  try {
    // A file may be unreadable on some ranks only: all have to agree.
    const std::string fault = petsc::world().first_text(refused.value_or(""));
    if (!fault.empty()) throw BadInput(fault);
    return answer(line, root, begin);
  } catch (const BadInput& error) {
    root.complain(fmt::format("mpmsolve: bad input: {}\n", error.what()));
    return ExitCode::bad_input;
  } catch (const NumericalFailure& error) {
    root.complain(fmt::format("mpmsolve: {}\n", error.what()));
    return ExitCode::numerical_failure;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "mpmsolve: rank %d: out of memory; larger cells, fewer particles per cell or more "
                 "machines need less\n",
                 session.rank());
    end_all_ranks(ExitCode::numerical_failure);
    return ExitCode::numerical_failure;
  } catch (const std::exception& error) {
    // Not agreed upon with the other ranks, which may be waiting: end them too.
    std::fprintf(stderr, "mpmsolve: rank %d: %s\n", session.rank(), error.what());
    end_all_ranks(ExitCode::numerical_failure);
    return ExitCode::numerical_failure;
  }
}

}  // namespace mpm::app
