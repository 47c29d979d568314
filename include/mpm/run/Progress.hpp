#pragma once

#include <chrono>
#include <string>

#include "mpm/run/RunOptions.hpp"

namespace mpm::run {

/// The progress line of a stage: share done, status, steps per second, time left. Renews itself
/// on a terminal; in a log a plain line each tenth of the stage. The first rank prints.
class Progress {
 public:
  Progress(ProgressDisplay display, bool is_root);

  void begin(const std::string& stage, long long step);
  void update(double share_done, long long step, const std::string& status);
  void end(long long step);
  /// A line for itself.
  void note(const std::string& line) const;

 private:
  using Clock = std::chrono::steady_clock;
  double seconds_since_begin() const;
  void print_line(const std::string& line, const char* ending) const;

  bool m_shown;
  bool m_terminal;
  std::string m_stage;
  long long m_first_step = 0;
  int m_next_tenth = 1;
  Clock::time_point m_begin, m_last;
};

}  // namespace mpm::run
