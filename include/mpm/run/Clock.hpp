#pragma once

#include "mpm/core/Archive.hpp"
#include "mpm/solver/StepTimes.hpp"

namespace mpm::run {

/// Whether a time that steps are cut to meet has come, s.
inline bool has_come(double time, double end) {
  return time >= end * (1.0 - 1e-14);
}

/// What time it is in a run. The run alone writes it; everyone else reads.
struct Clock {
  long long step = 0;  ///< steps since the start of the run
  double time = 0.0;   ///< s, since the start of the run or of the last stage that began anew
  int stage = 0;       ///< stages that are over
  long long steps_in_stage = 0;
  double time_in_stage = 0.0;  ///< s
  /// Since the main stage began, where limits and outputs count; 0 before.
  long long counted_steps = 0;
  double counted_time = 0.0;  ///< s
  bool is_counting = false;
  double dt = 0.0;           ///< s, of the last step
  double momentum_dt = 0.0;  ///< s, over which the last step's forces changed momentum

  void begin_stage(bool counts) {
    steps_in_stage = 0;
    time_in_stage = 0.0;
    is_counting = is_counting || counts;
  }

  void advance(const solver::StepTimes& times) {
    dt = times.dt;
    momentum_dt = times.momentum_dt();
    time += dt;
    time_in_stage += dt;
    ++step;
    ++steps_in_stage;
    if (!is_counting) return;
    counted_time += dt;
    ++counted_steps;
  }

  void persist(Archive& archive) {
    archive("step", step);
    archive("time", time);
    archive("stage", stage);
    archive("steps_in_stage", steps_in_stage);
    archive("time_in_stage", time_in_stage);
    archive("counted_steps", counted_steps);
    archive("counted_time", counted_time);
    archive("is_counting", is_counting);
    archive("dt", dt);
    archive("momentum_dt", momentum_dt);
  }
};

}  // namespace mpm::run
