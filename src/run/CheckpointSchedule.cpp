#include "mpm/run/CheckpointSchedule.hpp"

#include <algorithm>
#include <chrono>

#include "mpm/run/Signals.hpp"

namespace mpm::run {
namespace {

using Clock = std::chrono::steady_clock;

const Clock::time_point process_begin = Clock::now();

/// Since the process began.
double seconds() {
  return std::chrono::duration<double>(Clock::now() - process_begin).count();
}

/// What is kept of a limit for the last step, the checkpoint and the end of the program, s.
double reserve(double limit) {
  return std::min(0.1 * limit, 60.0);
}

}  // namespace

CheckpointSchedule::CheckpointSchedule(const CheckpointOptions& options, bool is_root)
    : m_options(options), m_is_root(is_root), m_last(seconds()) {}

int CheckpointSchedule::wishes() const {
  int wishes = (take_request_for_checkpoint() ? asked : 0) | (is_asked_to_end() ? end_asked : 0);
  if (!m_is_root) return wishes;
  const double now = seconds(), spacing = 60.0 * m_options.wall_minutes;
  if (spacing > 0.0 && now - m_last >= spacing) wishes |= timed;
  if (!m_options.wall_time_limit) return wishes;
  const double limit = 60.0 * *m_options.wall_time_limit;
  return now >= limit - reserve(limit) ? wishes | end_by_limit : wishes;
}

bool CheckpointSchedule::is_due(long long step, int wishes) const {
  return wishes != 0 || (m_options.every > 0 && step > m_last_step && step % m_options.every == 0);
}

void CheckpointSchedule::written(long long step) {
  m_last = seconds();
  m_last_step = step;
}

}  // namespace mpm::run
