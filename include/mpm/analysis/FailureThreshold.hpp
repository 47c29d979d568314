#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mpm/analysis/BearingCapacity.hpp"
#include "mpm/analysis/SlopeFit.hpp"

namespace mpm::analysis {

struct ThresholdOptions {
  double window = 0.75;        ///< largest u/D looked at; the stroke of the model tests
  double smallest_fall = 0.3;  ///< of the slope, below which there is no threshold
  double tooth_period = 0.0;   ///< in u/D: a cell over D where grid lines make saw-teeth, else 0
  int resamples = 500;         ///< curves drawn for the interval
  double confidence = 0.95;    ///< of the interval
  std::uint64_t seed = 20220710;
};

struct Interval {
  double low = 0.0;
  double high = 0.0;
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
  double slope_before = 0.0;     ///< fitted slope before the descent
  double slope_after = 0.0;      ///< fitted slope of the stable segment
  double resamples_found = 0.0;  ///< share of drawn curves that had a break
  SlopeFit fit;
};

/// The two segments of read_slope() are fitted to the slope curve, not to N_d: the paper takes "the
/// intersection between the descending segment and the stable segment of the slope curve". Teeth
/// of the given period are taken off N_d before.
///
/// The true threshold of a curve with scatter is the one this reading gives for the same curve
/// without scatter and saw-teeth, over the same window; the interval holds it in the given share of
/// cases. It comes from reading the curve with more scatter of its own kind, as CurveScatter finds
/// it. Residuals of the fit would not do: they are mostly its misfit, which is the same in every
/// run. With the seed it is deterministic; NaN for a curve too short to judge its scatter, and
/// without resamples. Thresholds below u/D = 0.05 cannot be resolved with steps of 0.01.
FailureThreshold failure_threshold(const SlopeCurve& curve, const ThresholdOptions& options = {});

/// That there is none over this window, and why.
FailureThreshold no_threshold(double window, std::string reason);

/// Content of threshold.csv: u_over_D, N_d, slope and, for each threshold, the fitted slope as
/// fit_to_<window>; "nan" where there is none.
std::string threshold_csv(const SlopeCurve& curve, std::span<const FailureThreshold> thresholds);

/// u_df_over_D, N_df, their _low and _high, slope_before, slope_after, threshold_window and
/// threshold_found (0 or 1), each with `suffix` appended.
SummaryValues threshold_summary(const FailureThreshold& threshold, const std::string& suffix = "");

}  // namespace mpm::analysis
