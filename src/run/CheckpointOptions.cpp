#include "mpm/run/CheckpointOptions.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace mpm::run {
namespace {

/// How a run goes on, where and on what, not what is computed.
constexpr std::array ways_to_go_on{"restart",         "checkpoint_every", "checkpoint_wall_minutes",
                                   "wall_time_limit", "progress",         "output_dir",
                                   "load_balance",    "rebalance_above"};
/// Where a run ends and what it writes on its way.
constexpr std::array ends_and_outputs{"end_time", "max_steps", "particle_output_every",
                                      "particle_output_times", "history_every"};

template <class List>
bool contains(const List& list, const std::string& option) {
  return std::ranges::find(list, option) != list.end();
}

}  // namespace

bool may_change_on_restart(const std::string& option) {
  return contains(ways_to_go_on, option) || contains(ends_and_outputs, option);
}

std::string options_that_may_change() {
  return fmt::format("-{}, -{}", fmt::join(ends_and_outputs, ", -"),
                     fmt::join(ways_to_go_on, ", -"));
}

bool leaves_results_alone(const std::string& option) {
  return contains(ways_to_go_on, option);
}

void CheckpointOptions::declare(options::OptionSet& options) {
  m_options = &options;
  options.integer(
      "checkpoint_every", every, {0, 1'000'000'000'000},
      {"steps", "steps between two checkpoints, from which a run can go on; 0 goes by time alone",
       "docs/restart.md"});
  options.real("checkpoint_wall_minutes", wall_minutes, {.minimum = 0.0, .maximum = 1e6},
               {"min", "wall time between two checkpoints; 0 goes by steps alone",
                "chosen: what a run loses at the most"});
  options.optional_real("wall_time_limit", wall_time_limit, options::positive(), "no limit",
                        {"min",
                         "the run writes a checkpoint and stops with exit code 75 so early that it "
                         "has ended by then: "
                         "a tenth of it before, at most a minute",
                         "docs/restart.md"});
  options.path(
      "restart", restart,
      {"",
       "checkpoint from which the run goes on; auto takes the one in the output directory, and "
       "begins anew where there is none",
       "docs/restart.md"});
  options.leave_out_of_used();
}

RunIdentity CheckpointOptions::identity() const {
  if (m_options == nullptr) return {};
  return {m_options->title(), m_options->values()};
}

}  // namespace mpm::run
