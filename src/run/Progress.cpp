#include "mpm/run/Progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <system_error>

namespace mpm::run {
namespace {

std::string duration(double seconds) {
  const auto whole = static_cast<long long>(seconds + 0.5);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

bool ends_at_terminal(pid_t process) {
  const std::string link = fmt::format("/proc/{}/fd/{}", process, STDOUT_FILENO);
  std::error_code error;
  const std::string target = std::filesystem::read_symlink(link, error).string();
  return target.starts_with("/dev/pts/") || target.starts_with("/dev/tty");
}

/// An MPI launcher may give its ranks a terminal of their own even where its output goes to a
/// file, so the launcher is asked too.
bool writes_to_terminal() {
  return isatty(STDOUT_FILENO) != 0 && ends_at_terminal(getppid());
}

}  // namespace

Progress::Progress(ProgressDisplay display, bool is_root)
    : m_shown(is_root && display != ProgressDisplay::off), m_terminal(writes_to_terminal()) {}

void Progress::print_line(const std::string& line, const char* ending) const {
  // Not fmt::print, which throws: a reader who has gone away must not end the run.
  const std::string text = m_terminal ? fmt::format("\r{:<100}{}", line, ending) : line + ending;
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

void Progress::note(const std::string& line) const {
  if (m_shown) print_line(line, "\n");
}

double Progress::seconds_since_begin() const {
  return std::chrono::duration<double>(Clock::now() - m_begin).count();
}

void Progress::begin(const std::string& stage, long long step) {
  m_stage = stage;
  m_first_step = step;
  m_next_tenth = 1;
  m_begin = m_last = Clock::now();
}

void Progress::update(double share_done, long long step, const std::string& status) {
  if (!m_shown) return;
  const auto now = Clock::now();
  const bool due =
      m_terminal ? now - m_last > std::chrono::milliseconds(500) : share_done >= 0.1 * m_next_tenth;
  if (!due) return;
  m_last = now;
  m_next_tenth = static_cast<int>(share_done * 10.0) + 1;
  const double seconds = seconds_since_begin();
  const double left =
      share_done > 0.0 ? seconds * std::max(0.0, 1.0 - share_done) / share_done : 0.0;
  const std::string line = fmt::format(
      "{}: {:3.0f} %  {}  {:.0f} steps/s  {} left", m_stage, 100.0 * std::min(share_done, 1.0),
      status, static_cast<double>(step - m_first_step) / seconds, duration(left));
  print_line(line, m_terminal ? "" : "\n");
}

void Progress::end(long long step) {
  if (!m_shown) return;
  const std::string line = fmt::format("{}: done, {} steps in {}", m_stage, step - m_first_step,
                                       duration(seconds_since_begin()));
  print_line(line, "\n");
}

}  // namespace mpm::run
