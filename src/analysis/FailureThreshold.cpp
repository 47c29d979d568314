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
/// A reading has settled on the scatter that is there, and more of it moves it less than the first
/// did: by factors that the study of known curves gives (docs/data/threshold_coverage.csv).
constexpr double widening_of_u_df = 1.15;
constexpr double widening_of_N_df = 1.08;

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

/// The N_d whose slope is the fitted one and whose mean up to the break is that of the curve.
std::vector<double> resistance_of(const SlopeFit& fit, const SlopeCurve& curve) {
  std::vector<double> shape;
  double N_d = 0.0, excess = 0.0, counted = 0.0;
  for (std::size_t k = 0; k < curve.N_d.size(); ++k) {
    shape.push_back(N_d);
    N_d += step_of(curve) * fit.value(curve.u_over_D[k] + 0.5 * step_of(curve));
    if (curve.u_over_D[k] < fit.start || curve.u_over_D[k] > fit.break_point) continue;
    excess += shape[k] - curve.N_d[k];
    counted += 1.0;
  }
  for (double& value : shape) value -= excess / counted;
  return shape;
}

/// Ends of the middle share of the values, `widening` times as far from the reading.
Interval interval(std::vector<double> values, double reading, double confidence, double widening) {
  if (values.empty()) return {none, none};
  std::sort(values.begin(), values.end());
  const double tail = 0.5 * (1.0 - confidence) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(std::lround(tail));
  return {reading + widening * (values[low] - reading),
          reading + widening * (values[values.size() - 1 - low] - reading)};
}

SlopeCurve curve_of_steps(const SlopeCurve& like, std::vector<double> N_d) {
  std::vector<double> slope = slopes_of_steps(N_d, step_of(like));
  return {like.u_over_D, std::move(N_d), std::move(slope)};
}

/// N_d at a drawn break: along the fit, whose N_d has no scatter, and the drawn scatter there. The
/// scatter of the curve itself would count twice.
double resistance_at(double at, const SlopeCurve& drawn, const SlopeCurve& curve,
                     const std::vector<double>& fitted, const FailureThreshold& threshold) {
  const auto& x = curve.u_over_D;
  return threshold.N_df + interpolated(x, fitted, at) -
         interpolated(x, fitted, threshold.u_df_over_D) + interpolated(x, drawn.N_d, at) -
         interpolated(x, curve.N_d, at);
}

/// Intervals from readings of the curve with more scatter of its own kind.
void set_intervals(const CurveScatter& scatter, const SlopeCurve& curve,
                   const ThresholdOptions& options, FailureThreshold& threshold) {
  const std::vector<double> fitted = resistance_of(threshold.fit, curve);
  std::mt19937_64 engine(options.seed);
  std::vector<double> breaks, resistances;
  for (int k = 0; k < options.resamples; ++k) {
    const SlopeCurve drawn = curve_of_steps(curve, scatter.with_more(engine));
    const SlopeReading read = read_slope(drawn, threshold.window);
    if (!read.found) continue;
    const double at = read.fit.break_point;
    breaks.push_back(at);
    resistances.push_back(resistance_at(at, drawn, curve, fitted, threshold));
  }
  const double share = options.confidence;
  threshold.resamples_found =
      static_cast<double>(breaks.size()) / static_cast<double>(std::max(options.resamples, 1));
  threshold.u_df_over_D_interval = interval(breaks, threshold.u_df_over_D, share, widening_of_u_df);
  threshold.N_df_interval = interval(resistances, threshold.N_df, share, widening_of_N_df);
}

std::string small_fall(const SlopeFit& fit, double smallest_fall) {
  return fmt::format("the slope falls from {:.4g} to {:.4g} only, less than {:.0f} %", fit.largest,
                     fit.stable, 100.0 * smallest_fall);
}

/// The threshold of the fit, yet without intervals.
FailureThreshold threshold_at(const SlopeFit& fit, const SlopeCurve& curve, double window) {
  FailureThreshold threshold = no_threshold(window, "");
  threshold.found = true;
  threshold.fit = fit;
  threshold.u_df_over_D = fit.break_point;
  threshold.N_df = interpolated(curve.u_over_D, curve.N_d, fit.break_point);
  threshold.slope_before = fit.largest;
  threshold.slope_after = fit.stable;
  return threshold;
}

bool is_positive_somewhere(const SlopeCurve& curve) {
  return std::any_of(curve.N_d.begin(), curve.N_d.end(), [](double N_d) { return N_d > 0.0; });
}

}  // namespace

FailureThreshold no_threshold(double window, std::string reason) {
  FailureThreshold threshold;
  threshold.reason = std::move(reason);
  threshold.window = window;
  threshold.u_df_over_D = threshold.N_df = none;
  threshold.u_df_over_D_interval = threshold.N_df_interval = {none, none};
  threshold.slope_before = threshold.slope_after = threshold.resamples_found = none;
  threshold.fit = {none, none, none, none, none};
  return threshold;
}

FailureThreshold failure_threshold(const SlopeCurve& curve, const ThresholdOptions& options) {
  const double end = curve.u_over_D.empty() ? 0.0 : curve.u_over_D.back();
  const double half_step = curve.u_over_D.empty() ? 0.0 : curve.u_over_D.front();
  const double window = std::min(options.window, end + half_step);
  const SlopeReading rough = read_slope(curve, window);
  if (!rough.found) return no_threshold(window, rough.reason);
  if (!is_positive_somewhere(curve)) return no_threshold(window, "N_d is nowhere positive");

  const CurveScatter scatter(curve.N_d, resistance_of(rough.fit, curve), step_of(curve),
                             options.tooth_period);
  const SlopeCurve smoother = curve_of_steps(curve, scatter.resistance());
  const SlopeReading read = read_slope(smoother, window);
  if (!read.found) return no_threshold(window, read.reason);
  if (read.fit.stable > (1.0 - options.smallest_fall) * read.fit.largest) {
    return no_threshold(window, small_fall(read.fit, options.smallest_fall));
  }
  FailureThreshold threshold = threshold_at(read.fit, smoother, window);
  if (options.resamples <= 0 || !scatter.can_be_judged()) return threshold;
  set_intervals(scatter, smoother, options, threshold);
  if (threshold.resamples_found >= fewest_readable) return threshold;
  return no_threshold(window,
                      fmt::format("the scatter of N_d hides it: only {:.0f} % of curves with "
                                  "such scatter have a break",
                                  100.0 * threshold.resamples_found));
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
