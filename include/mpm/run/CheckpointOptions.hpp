#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mpm/options/OptionSet.hpp"

namespace mpm::run {

/// What a run is, so that a checkpoint is put back into no other: scene and options.
struct RunIdentity {
  std::string scene;
  std::vector<std::pair<std::string, std::string>> options;  ///< name and value
};

/// When a run writes checkpoints and stops early, and from which it goes on.
struct CheckpointOptions {
  std::int64_t every = 0;                 ///< steps; 0 never
  double wall_minutes = 30.0;             ///< 0 never
  std::optional<double> wall_time_limit;  ///< min
  std::string restart;                    ///< file, "auto", or empty

  void declare(options::OptionSet& options);
  /// Of the options among which these have been declared, as they are now; empty before.
  RunIdentity identity() const;

 private:
  const options::OptionSet* m_options = nullptr;
};

/// The word of -restart that takes the checkpoint in the output directory, if there is one.
inline constexpr auto restart_if_possible = "auto";

/// The one list of options that a run may change when it goes on.
bool may_change_on_restart(const std::string& option);
/// The same for people.
std::string options_that_may_change();
/// Of these, the ones that do not change what a finished run has found out.
bool leaves_results_alone(const std::string& option);

}  // namespace mpm::run
