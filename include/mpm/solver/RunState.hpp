#pragma once

namespace mpm::solver {

/// All that a run knows besides grid and particles; what a bitwise restart has to put back.
struct RunState {
  long long step = 0;
  double time = 0.0;              ///< s
  double dt = 0.0;                ///< s, of the step to come
  double dt_old = 0.0;            ///< s, of the last step; 0 halves the next change of momentum
  double last_momentum_dt = 0.0;  ///< s, over which the last step's forces changed momentum
  int steps_since_renewal = 0;    ///< of dt
  int steps_since_sort = 0;
  int stage = 0;
  long long steps_in_stage = 0;
  double time_in_stage = 0.0;  ///< s

  /// The time over which forces change momentum: velocities live at half steps.
  double momentum_dt() const { return 0.5 * (dt_old + dt); }
};

}  // namespace mpm::solver
