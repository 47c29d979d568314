#pragma once

#include "mpm/run/CheckpointOptions.hpp"

namespace mpm::run {

/// Says when a checkpoint is due. What hangs on clocks and signals one rank knows and all have to
/// hear of: its wishes go along with the next step.
class CheckpointSchedule {
 public:
  CheckpointSchedule(const CheckpointOptions& options, bool is_root);

  /// Bits of wishes.
  enum Wish { timed = 1, asked = 2, end_asked = 4, end_by_limit = 8 };

  /// This rank's, as bits. Local.
  int wishes() const;
  /// Whether one is due before the step after `step`, given what all ranks wish.
  bool is_due(long long step, int wishes) const;
  /// Whether the run has to end then.
  static bool has_to_end(int wishes) { return (wishes & (end_asked | end_by_limit)) != 0; }
  /// One has been written, or put back, after this step.
  void written(long long step);

 private:
  CheckpointOptions m_options;
  bool m_is_root;
  double m_last;  ///< s of the process
  long long m_last_step = 0;
};

}  // namespace mpm::run
