#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mpm/analysis/BearingCapacity.hpp"

namespace mpm::analysis {

/// The resistance curve on equal steps of u/D and its slope, one entry per step, dimensionless.
struct SlopeCurve {
  std::vector<double> u_over_D;  ///< middle of the step
  std::vector<double> N_d;       ///< mean over the step
  std::vector<double> slope;     ///< dN_d/d(u/D); NaN in the two first and the two last steps
};

/// Averages the curve on steps of `step` in u/D and differentiates it by a quadratic through five
/// steps (least squares). Row k of the input is the mean N_d since row k - 1 (row 0: since u = 0),
/// as history.csv has it. A last step that is covered by less than half is left out.
/// Throws BadInput for unequal lengths, a value that is not finite, or u/D that falls.
SlopeCurve slope_curve(std::span<const double> u_over_D, std::span<const double> N_d,
                       double step = 0.01);

struct ThresholdOptions {
  double window = 0.75;        ///< largest u/D looked at; the stroke of the model tests
  double smallest_fall = 0.3;  ///< of the slope, below which there is no threshold
  int resamples = 500;         ///< of the bootstrap
  double confidence = 0.95;    ///< of the interval
  std::uint64_t seed = 20220710;
};

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

/// Two lines through the slope curve that meet at the break.
struct SlopeFit {
  double start = 0.0;           ///< u/D of the largest slope
  double break_point = 0.0;     ///< u/D
  double value_at_start = 0.0;  ///< slope there
  double descent = 0.0;         ///< gradient of the descending segment, per unit of u/D
  double drift = 0.0;           ///< gradient of the stable segment

  /// Fitted slope at u/D (start and beyond).
  double value(double u_over_D) const;
};

/// Transition of the resistance curve from its nonlinear to its steady stage (Fig. 9). All numbers
/// but `window` are NaN when `found` is false; `reason` then says why, for the user.
struct FailureThreshold {
  bool found = false;
  std::string reason;
  double window = 0.0;  ///< largest u/D that was really available, at most the one asked for
  double u_df_over_D = 0.0;
  double N_df = 0.0;  ///< averaged curve at the break
  Interval u_df_over_D_interval;
  Interval N_df_interval;
  double slope_before = 0.0;     ///< fitted slope at its largest
  double slope_after = 0.0;      ///< mean fitted slope of the stable segment
  double resamples_found = 0.0;  ///< share of bootstrap samples that had a break
  SlopeFit fit;
};

/// The two segments are fitted to the slope curve, not to N_d: the paper takes "the intersection
/// between the descending segment and the stable segment of the slope curve", and a continuous
/// broken line has its break exactly there. It starts at the largest slope; the break is free, the
/// descending segment falls, and the stable one falls less. The interval is a bootstrap over
/// blocks of five residuals, the reach of the slope's quadratic; with the seed it is deterministic.
/// Thresholds below u/D = 0.05 cannot be resolved with steps of 0.01.
FailureThreshold failure_threshold(const SlopeCurve& curve, const ThresholdOptions& options = {});

/// Content of threshold.csv: u_over_D, N_d, slope and, for each threshold, the fitted slope as
/// fit_to_<window>; "nan" where there is none.
std::string threshold_csv(const SlopeCurve& curve, std::span<const FailureThreshold> thresholds);

/// u_df_over_D, N_df, their _low and _high, slope_before, slope_after, threshold_window and
/// threshold_found (0 or 1), each with `suffix` appended.
SummaryValues threshold_summary(const FailureThreshold& threshold, const std::string& suffix = "");

}  // namespace mpm::analysis
