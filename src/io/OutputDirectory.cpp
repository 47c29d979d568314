#include "mpm/io/OutputDirectory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <fstream>
#include <utility>

#include "mpm/core/Errors.hpp"
#include "mpm/io/ResultFiles.hpp"

namespace mpm::io {
namespace {

namespace fs = std::filesystem;

constexpr auto list_head =
    "# Files that mpmsolve has written here; the next run into this directory replaces them.\n";
constexpr auto allowed_directory = "a directory that can be made and written";
constexpr auto name_another = "name another directory";
constexpr std::size_t longest_result_name = 64;  // with room to spare
constexpr std::size_t shown_names = 3;
constexpr int most_attempts = 100;

bool is_file(const fs::path& path) {
  std::error_code ignored;  // what cannot be seen is none
  return fs::is_regular_file(fs::symlink_status(path, ignored));
}

/// The first part of a path that is there and no directory, or a link that leads nowhere.
fs::path obstacle(const fs::path& path) {
  fs::path part;
  std::error_code ignored;  // what cannot be seen is not it
  for (const fs::path& name : path) {
    part /= name;
    if (fs::exists(fs::symlink_status(part, ignored)) && !fs::is_directory(part, ignored))
      return part;
  }
  return path;
}

std::string fault_of_obstacle(const fs::path& path) {
  std::error_code ignored;  // told by the words
  const fs::path what = obstacle(path);
  if (!fs::is_symlink(what, ignored) || fs::exists(what, ignored))
    return fmt::format("has '{}' in its way, which is no directory", what.string());
  return fmt::format("has '{}' in its way, a link to '{}', which is not there", what.string(),
                     fs::read_symlink(what, ignored).string());
}

/// Locks a file for this process; returns the error, 0 if there is none.
int lock(int file) {
  int result = 0;
  do result = flock(file, LOCK_EX | LOCK_NB);
  while (result != 0 && errno == EINTR);
  return result == 0 ? 0 : errno;
}

/// Whether a path still leads to the open file, which a run that ends may have taken away.
bool leads_to(const fs::path& path, int file) {
  struct stat opened {
  }, present{};
  return fstat(file, &opened) == 0 && lstat(path.c_str(), &present) == 0 &&
         opened.st_ino == present.st_ino && opened.st_dev == present.st_dev;
}

bool remove_if_there(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  return !error;
}

}  // namespace

/// What the first rank finds wrong all ranks throw.
template <class Action>
void OutputDirectory::on_root(const Action& action) const {
  std::string fault;
  if (m_communicator.is_root()) try {
      action();
    } catch (const BadInput& error) {
      fault = error.what();
    } catch (const fs::filesystem_error& error) {
      fault = fmt::format("-output_dir {}: {}; {}", m_path.string(), error.what(), name_another);
    }
  m_communicator.broadcast(fault);
  if (!fault.empty()) throw BadInput(fault);
}

void OutputDirectory::refuse(const std::string& fault, const std::string& remedy) const {
  throw options::bad_input({m_given, fault, allowed_directory, remedy});
}

void OutputDirectory::refuse_for(int error, const fs::path& place) const {
  if (error == EEXIST || error == ENOTDIR)
    refuse(fault_of_obstacle(place), fmt::format("remove that, or {}", name_another));
  if (error == ELOOP) refuse("has links in it that lead in a circle", "correct the links");
  if (error == ENAMETOOLONG)
    refuse(fmt::format("is too long, names have at most {} bytes and paths {}", NAME_MAX, PATH_MAX),
           "name a shorter one");
  if (error == EACCES || error == EPERM)
    refuse(fmt::format("may not be written: no permission at '{}'", place.string()),
           fmt::format("{}, or have its owner allow it", name_another));
  if (error == EROFS)
    refuse(fmt::format("lies on a file system that can only be read, at '{}'", place.string()),
           name_another);
  if (error == ENOENT)
    refuse(fmt::format("cannot be made: '{}' takes no new files", place.parent_path().string()),
           name_another);
  refuse(fmt::format("cannot be made or written at '{}': {}", place.string(), std::strerror(error)),
         fmt::format("see to that, or {}", name_another));
}

OutputDirectory::OutputDirectory(options::Given given, Unlisted allowed,
                                 const petsc::Communicator& communicator)
    : m_given(std::move(given)), m_path(m_given.value), m_communicator(communicator) {
  try {
    on_root([&] {
      open();
      check_list();
      check_way(allowed);
    });
  } catch (const BadInput&) {
    leave();
    throw;
  }
}

OutputDirectory::~OutputDirectory() {
  leave();
}

/// A list that was there, and whatever a second run has put into the directory, stays.
void OutputDirectory::leave() const {
  if (!m_has_begun && m_has_made_list) remove_if_there(m_path / list_of_results);
  if (m_list >= 0) close(m_list);
  if (m_has_begun) return;
  for (auto made = m_made.rbegin(); made != m_made.rend(); ++made) remove_if_there(*made);
}

void OutputDirectory::open() {
  if (fs::absolute(m_path).string().size() + longest_result_name > PATH_MAX)
    refuse_for(ENAMETOOLONG, m_path);
  make();
  if (access(m_path.c_str(), W_OK | X_OK) != 0) refuse_for(errno, m_path);
  for (int attempt = 0; m_list < 0; ++attempt) {
    if (attempt == most_attempts) refuse_for(ESTALE, m_path / list_of_results);
    hold();
  }
}

void OutputDirectory::make() {
  fs::path place;
  for (const fs::path& name : m_path) {
    place /= name;
    struct stat status {};
    if (stat(place.c_str(), &status) == 0) {
      if (!S_ISDIR(status.st_mode)) refuse_for(ENOTDIR, place);
    } else if (errno != ENOENT) {
      refuse_for(errno, place);
    } else if (lstat(place.c_str(), &status) == 0) {
      refuse_for(ENOTDIR, place);  // a link that leads nowhere
    } else if (mkdir(place.c_str(), 0777) == 0) {
      m_made.push_back(place);
    } else if (errno != EEXIST || !fs::is_directory(place)) {  // another run may have been first
      refuse_for(errno, place);
    }
  }
}

/// Opens the list and locks it; does nothing where another run has taken it away meanwhile.
void OutputDirectory::hold() {
  const fs::path path = m_path / list_of_results;
  constexpr int way = O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  std::error_code ignored;  // what cannot be seen cannot be opened either
  if (fs::exists(fs::symlink_status(path, ignored)) && !is_file(path))
    refuse(fmt::format("has '{}' in it, which is no file", list_of_results), name_another);
  int file = ::open(path.c_str(), way | O_CREAT | O_EXCL, 0666);
  m_has_made_list = file >= 0;
  if (file < 0 && errno == EEXIST) file = ::open(path.c_str(), way);
  if (file < 0 && errno == ENOENT) return;
  if (file < 0) refuse_for(errno, path);
  const int error = lock(file);
  if (error == EWOULDBLOCK) {
    m_has_made_list = false;  // the other run has it
    close(file);
    refuse("is in use: another run writes into it", fmt::format("let it end, or {}", name_another));
  }
  if (error != 0) m_without_lock = std::strerror(error);
  if (leads_to(path, file))
    m_list = file;
  else
    close(file);
}

std::vector<std::string> OutputDirectory::listed() const {
  std::ifstream list(m_path / list_of_results);
  std::vector<std::string> names;
  for (std::string name; std::getline(list, name);)
    if (!name.starts_with('#') && !name.empty()) names.push_back(name);
  return names;
}

bool OutputDirectory::is_listed(const std::string& name) const {
  const auto names = listed();
  return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> OutputDirectory::names_in_the_way(Unlisted allowed) const {
  const std::vector<std::string> known = listed();
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(m_path)) {
    const std::string name = entry.path().filename().string();
    if (!is_result_name(name)) continue;
    if (allowed == Unlisted::checkpoint && name.starts_with("checkpoint.h5")) continue;
    const std::string whole = name.ends_with(".part") ? name.substr(0, name.size() - 5) : name;
    const bool is_ours = std::ranges::find(known, whole) != known.end() && is_file(entry.path());
    if (!is_ours) names.push_back(name);
  }
  std::ranges::sort(names);
  return names;
}

/// Lists of earlier versions had no head.
void OutputDirectory::check_list() const {
  std::ifstream list(m_path / list_of_results);
  std::string first;
  std::getline(list, first);
  if (first + "\n" == list_head) return;
  for (const std::string& name : listed())
    if (!is_result_name(name))
      refuse(fmt::format("has a file '{}' in it that is no list of results: '{}'", list_of_results,
                         name),
             fmt::format("move that file, or {}", name_another));
}

void OutputDirectory::check_way(Unlisted allowed) const {
  std::vector<std::string> names = names_in_the_way(allowed);
  if (names.empty()) return;
  const std::size_t others = names.size() - std::min(names.size(), shown_names);
  names.resize(names.size() - others);
  refuse(fmt::format("has files in it that this run would replace and no run has listed in {}: "
                     "{}{}",
                     list_of_results, fmt::join(names, ", "),
                     others == 0 ? "" : fmt::format(" and {} more", others)),
         fmt::format("move them, or {}", name_another));
}

void OutputDirectory::check_input(const options::Given& file) const {
  on_root([&] {
    std::error_code ignored;  // of two that cannot be compared one is not there
    const fs::path path(file.value);
    const bool is_here = fs::equivalent(fs::absolute(path).parent_path(), m_path, ignored);
    if (!is_here || !is_listed(path.filename().string())) return;
    throw options::bad_input(
        {.given = file,
         .fault = "is a result of an earlier run, which this one replaces",
         .allowed = "a file that stays",
         .remedy = fmt::format("copy it, or {} as -output_dir", name_another)});
  });
}

bool OutputDirectory::remove_listed(const std::string& name) const {
  const fs::path part = m_path / (name + ".part");
  const bool was_there = is_file(m_path / name);
  if (remove_if_there(m_path / name) && remove_if_there(part)) return was_there;
  refuse_for(EACCES, m_path / name);
}

std::size_t OutputDirectory::begin_anew() {
  std::size_t count = 0;
  on_root([&] {
    check_way(Unlisted::none);
    m_has_begun = true;
    for (const std::string& name : listed())
      if (is_result_name(name)) count += remove_listed(name) ? 1 : 0;
    const auto size = static_cast<ssize_t>(std::strlen(list_head));
    if (ftruncate(m_list, 0) != 0 || pwrite(m_list, list_head, std::strlen(list_head), 0) != size)
      refuse_for(errno, m_path / list_of_results);
  });
  m_has_begun = true;
  return count;
}

void OutputDirectory::go_on() {
  on_root([&] {
    for (const std::string& name : listed())
      if (is_result_name(name)) remove_if_there(m_path / (name + ".part"));
    for (const char* end : {"summary.json", "failure.json"}) remove_if_there(m_path / end);
    if (is_file(m_path / "checkpoint.h5") && !is_listed("checkpoint.h5"))
      std::ofstream(m_path / list_of_results, std::ios::app) << "checkpoint.h5\n";
  });
  m_has_begun = true;
}

}  // namespace mpm::io
