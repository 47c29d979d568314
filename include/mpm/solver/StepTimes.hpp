#pragma once

namespace mpm::solver {

/// The times of one step.
struct StepTimes {
  double time = 0.0;    ///< s, at its beginning
  double dt = 0.0;      ///< s
  double dt_old = 0.0;  ///< s, of the step before; 0 halves this step's change of momentum

  /// The time over which forces change momentum, s: velocities live at half steps.
  double momentum_dt() const { return 0.5 * (dt_old + dt); }
};

}  // namespace mpm::solver
