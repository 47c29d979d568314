#include "mpm/analysis/FailureThreshold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include "mpm/analysis/CurveScatter.hpp"

namespace mpm::analysis {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double fewest_readable = 0.5;  ///< share of drawn curves that must have a break

double interpolated(const std::vector<double>& u_over_D, const std::vector<double>& N_d,
                    double at) {
  const auto next = std::upper_bound(u_over_D.begin() + 1, u_over_D.end() - 1, at);
  const auto k = static_cast<std::size_t>(next - u_over_D.begin());
  const double share = (at - u_over_D[k - 1]) / (u_over_D[k] - u_over_D[k - 1]);
  return (1.0 - share) * N_d[k - 1] + share * N_d[k];
}

double step_of(const SlopeCurve& curve) {
  return curve.u_over_D[1] - curve.u_over_D[0];
}

/// The N_d whose slope is the fitted one, with the mean of the curve from the start on; not below
/// 0.
std::vector<double> resistance_of(const SlopeFit& fit, const SlopeCurve& curve) {
  std::vector<double> shape;
  double N_d = 0.0, excess = 0.0, counted = 0.0;
  for (std::size_t k = 0; k < curve.N_d.size(); ++k) {
    shape.push_back(N_d);
    N_d += step_of(curve) * fit.value(curve.u_over_D[k] + 0.5 * step_of(curve));
    if (curve.u_over_D[k] < fit.start) continue;
    excess += shape[k] - curve.N_d[k];
    counted += 1.0;
  }
  for (double& value : shape) value = std::max(value - excess / counted, 0.0);
  return shape;
}

/// The reading less the errors, largest error first.
Interval without(double reading, std::vector<double> errors, double confidence) {
  if (errors.empty()) return {none, none};
  std::sort(errors.begin(), errors.end());
  const double tail = 0.5 * (1.0 - confidence) * static_cast<double>(errors.size() - 1);
  const auto low = static_cast<std::size_t>(std::lround(tail));
  return {reading - errors[errors.size() - 1 - low], reading - errors[low]};
}

SlopeCurve curve_of_steps(const SlopeCurve& like, std::vector<double> N_d) {
  std::vector<double> slope = slopes_of_steps(N_d, step_of(like));
  return {like.u_over_D, std::move(N_d), std::move(slope)};
}

/// Intervals from the errors that the reading makes on drawn curves, whose threshold is known.
void set_intervals(const SlopeCurve& curve, const ThresholdOptions& options,
                   FailureThreshold& threshold) {
  threshold.u_df_over_D_interval = threshold.N_df_interval = {none, none};
  const CurveScatter scatter(curve.N_d, resistance_of(threshold.fit, curve), step_of(curve),
                             {.tooth_period = options.tooth_period});
  const SlopeReading known = read_slope(curve_of_steps(curve, scatter.smooth()), threshold.window);
  if (!known.found) return;
  const double u_df = known.fit.break_point;
  const double N_df = interpolated(curve.u_over_D, scatter.smooth(), u_df);

  std::mt19937_64 engine(options.seed);
  std::vector<double> u_errors, N_errors;
  for (int k = 0; k < options.resamples; ++k) {
    const SlopeCurve drawn = curve_of_steps(curve, scatter.draw(engine));
    const SlopeReading read = read_slope(drawn, threshold.window);
    if (!read.found) continue;
    u_errors.push_back(read.fit.break_point - u_df);
    N_errors.push_back(interpolated(curve.u_over_D, drawn.N_d, read.fit.break_point) - N_df);
  }
  threshold.resamples_found =
      static_cast<double>(u_errors.size()) / static_cast<double>(std::max(options.resamples, 1));
  threshold.u_df_over_D_interval = without(threshold.u_df_over_D, u_errors, options.confidence);
  threshold.N_df_interval = without(threshold.N_df, N_errors, options.confidence);
}

FailureThreshold not_found(double window, std::string reason) {
  FailureThreshold threshold;
  threshold.reason = std::move(reason);
  threshold.window = window;
  threshold.u_df_over_D = threshold.N_df = none;
  threshold.u_df_over_D_interval = threshold.N_df_interval = {none, none};
  threshold.slope_before = threshold.slope_after = threshold.resamples_found = none;
  threshold.fit = {none, none, none, none, none};
  return threshold;
}

}  // namespace

FailureThreshold failure_threshold(const SlopeCurve& curve, const ThresholdOptions& options) {
  const double end = curve.u_over_D.empty() ? 0.0 : curve.u_over_D.back();
  const double half_step = curve.u_over_D.empty() ? 0.0 : curve.u_over_D.front();
  const double window = std::min(options.window, end + half_step);
  const SlopeReading read = read_slope(curve, window);
  if (!read.found) return not_found(window, read.reason);
  const SlopeFit& fit = read.fit;
  if (fit.stable > (1.0 - options.smallest_fall) * fit.largest) {
    return not_found(window, fmt::format("the slope falls from {:.4g} to {:.4g} only, less than "
                                         "{:.0f} %",
                                         fit.largest, fit.stable, 100.0 * options.smallest_fall));
  }
  FailureThreshold threshold;
  threshold.found = true;
  threshold.window = window;
  threshold.fit = fit;
  threshold.u_df_over_D = fit.break_point;
  threshold.N_df = interpolated(curve.u_over_D, curve.N_d, fit.break_point);
  threshold.slope_before = fit.largest;
  threshold.slope_after = fit.stable;
  set_intervals(curve, options, threshold);
  if (options.resamples > 0 && threshold.resamples_found < fewest_readable) {
    return not_found(window, fmt::format("the scatter of N_d hides it: only {:.0f} % of curves "
                                         "with such scatter have a break",
                                         100.0 * threshold.resamples_found));
  }
  return threshold;
}

std::string threshold_csv(const SlopeCurve& curve, std::span<const FailureThreshold> thresholds) {
  std::string text = "u_over_D,N_d,slope";
  for (const auto& threshold : thresholds) text += fmt::format(",fit_to_{:.4g}", threshold.window);
  text += '\n';
  for (std::size_t k = 0; k < curve.u_over_D.size(); ++k) {
    const double u_over_D = curve.u_over_D[k];
    text += fmt::format("{:.17g},{:.17g},{:.17g}", u_over_D, curve.N_d[k], curve.slope[k]);
    for (const auto& threshold : thresholds) {
      const bool inside = u_over_D >= threshold.fit.start && u_over_D <= threshold.window;
      text += fmt::format(",{:.17g}", inside ? threshold.fit.value(u_over_D) : none);
    }
    text += '\n';
  }
  return text;
}

SummaryValues threshold_summary(const FailureThreshold& threshold, const std::string& suffix) {
  return {{"threshold_found" + suffix, threshold.found ? 1.0 : 0.0},
          {"threshold_window" + suffix, threshold.window},
          {"N_df" + suffix, threshold.N_df},
          {"N_df_low" + suffix, threshold.N_df_interval.low},
          {"N_df_high" + suffix, threshold.N_df_interval.high},
          {"u_df_over_D" + suffix, threshold.u_df_over_D},
          {"u_df_over_D_low" + suffix, threshold.u_df_over_D_interval.low},
          {"u_df_over_D_high" + suffix, threshold.u_df_over_D_interval.high},
          {"slope_before" + suffix, threshold.slope_before},
          {"slope_after" + suffix, threshold.slope_after},
          {"threshold_resamples_found" + suffix, threshold.resamples_found}};
}

}  // namespace mpm::analysis
