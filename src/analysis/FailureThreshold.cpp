#include "mpm/analysis/FailureThreshold.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <random>

#include "mpm/core/Errors.hpp"

namespace mpm::analysis {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t fewest_descending_points = 3;
constexpr std::size_t fewest_stable_points = 5;
constexpr std::size_t block_length = 5;
constexpr double break_spacing = 0.002;

/// The part of the slope curve that is fitted.
struct Points {
  std::vector<double> x;
  std::vector<double> y;
};

void check(std::span<const double> u_over_D, std::span<const double> N_d) {
  if (u_over_D.size() != N_d.size()) {
    throw BadInput(fmt::format("failure threshold: {} displacements but {} resistances",
                               u_over_D.size(), N_d.size()));
  }
  double previous = 0.0;
  for (std::size_t k = 0; k < N_d.size(); ++k) {
    if (!std::isfinite(N_d[k]) || !std::isfinite(u_over_D[k]) || u_over_D[k] < previous) {
      throw BadInput(
          fmt::format("failure threshold: row {} has u/D = {}, N_d = {}; both must be "
                      "finite and u/D must not fall below {}",
                      k, u_over_D[k], N_d[k], previous));
    }
    previous = u_over_D[k];
  }
}

/// Steps of the averaged curve that are covered by at least half.
std::size_t number_of_steps(std::span<const double> u_over_D, double step) {
  return u_over_D.empty() ? 0 : static_cast<std::size_t>(u_over_D.back() / step + 0.5 + 1e-9);
}

/// Mean over each step of the piecewise constant curve that the rows are.
std::vector<double> averaged(std::span<const double> u_over_D, std::span<const double> N_d,
                             double step) {
  const std::size_t steps = number_of_steps(u_over_D, step);
  std::vector<double> sum(steps, 0.0);
  std::vector<double> covered(steps, 0.0);
  double from = 0.0;
  for (std::size_t row = 0; row < N_d.size(); from = u_over_D[row++]) {
    for (auto k = static_cast<std::size_t>(from / step); k < steps; ++k) {
      const double low = std::max(from, step * static_cast<double>(k));
      const double high = std::min(u_over_D[row], step * static_cast<double>(k + 1));
      if (low >= u_over_D[row]) break;
      sum[k] += N_d[row] * std::max(high - low, 0.0);
      covered[k] += std::max(high - low, 0.0);
    }
  }
  std::transform(sum.begin(), sum.end(), covered.begin(), sum.begin(), std::divides<>());
  return sum;
}

Points points_to_fit(const SlopeCurve& curve, double window) {
  Points all;
  for (std::size_t k = 0; k < curve.slope.size(); ++k) {
    if (std::isnan(curve.slope[k]) || curve.u_over_D[k] > window) continue;
    all.x.push_back(curve.u_over_D[k]);
    all.y.push_back(curve.slope[k]);
  }
  // The last of equal ones: a plateau before the descent is no part of it.
  const double largest = all.y.empty() ? 0.0 : *std::max_element(all.y.begin(), all.y.end());
  const auto last = std::find_if(all.y.rbegin(), all.y.rend(), [largest](double y) {
    return y >= largest - 1e-9 * std::abs(largest);
  });
  const auto skipped = std::distance(last, all.y.rend()) - (all.y.empty() ? 0 : 1);
  all.x.erase(all.x.begin(), all.x.begin() + skipped);
  all.y.erase(all.y.begin(), all.y.begin() + skipped);
  return all;
}

/// Sums over the points on one side of a break, about the break: of 1, t, t^2, y, t y, y^2 with
/// t = x - break.
struct Moments {
  double n = 0.0, t = 0.0, tt = 0.0, y = 0.0, ty = 0.0, yy = 0.0;

  void add(double distance, double value) {
    n += 1.0;
    t += distance;
    tt += distance * distance;
    y += value;
    ty += distance * value;
    yy += value * value;
  }
};

struct Candidate {
  SlopeFit fit;
  double residual = std::numeric_limits<double>::infinity();
};

/// Least squares of y = v + descent t (t < 0), v + drift t (t >= 0) for a given break.
Candidate fit_with_break(const Points& points, double break_point) {
  Moments left, right;
  for (std::size_t k = 0; k < points.x.size(); ++k) {
    const double t = points.x[k] - break_point;
    (t < 0.0 ? left : right).add(t, points.y[k]);
  }
  Candidate result;
  // Elimination of both gradients leaves one equation for the value at the break.
  const double weight = left.n + right.n - left.t * left.t / left.tt - right.t * right.t / right.tt;
  const double at_break =
      (left.y + right.y - left.t * left.ty / left.tt - right.t * right.ty / right.tt) / weight;
  SlopeFit& fit = result.fit;
  fit.start = points.x.front();
  fit.break_point = break_point;
  fit.descent = (left.ty - at_break * left.t) / left.tt;
  fit.drift = (right.ty - at_break * right.t) / right.tt;
  fit.value_at_start = at_break + fit.descent * (fit.start - break_point);
  result.residual = left.yy + right.yy - at_break * (left.y + right.y) - fit.descent * left.ty -
                    fit.drift * right.ty;
  return result;
}

bool has_knee(const SlopeFit& fit) {
  return fit.descent < 0.0 && fit.drift > fit.descent;
}

/// The best broken line; none when the points are too few or bend the other way.
std::optional<SlopeFit> best_fit(const Points& points) {
  const std::size_t size = points.x.size();
  if (size < fewest_descending_points + fewest_stable_points) return std::nullopt;
  const double first = points.x[fewest_descending_points - 1];
  const double last = points.x[size - fewest_stable_points];
  Candidate best;
  const auto trials = static_cast<int>((last - first) / break_spacing + 1e-9);
  for (int k = 1; k <= trials; ++k) {
    const Candidate candidate = fit_with_break(points, first + break_spacing * k);
    if (has_knee(candidate.fit) && candidate.residual < best.residual) best = candidate;
  }
  if (std::isinf(best.residual)) return std::nullopt;
  return best.fit;
}

double interpolated(const SlopeCurve& curve, double u_over_D) {
  const auto& x = curve.u_over_D;
  const auto next = std::upper_bound(x.begin() + 1, x.end() - 1, u_over_D);
  const auto k = static_cast<std::size_t>(std::distance(x.begin(), next));
  const double share = (u_over_D - x[k - 1]) / (x[k] - x[k - 1]);
  return (1.0 - share) * curve.N_d[k - 1] + share * curve.N_d[k];
}

/// The fitted curve with residuals drawn in blocks, since neighbouring slopes share data.
Points resampled(const Points& points, const SlopeFit& fit, std::mt19937_64& engine) {
  Points sample = points;
  const std::size_t starts = points.x.size() - block_length + 1;
  std::size_t source = 0;
  for (std::size_t k = 0; k < points.x.size(); ++k, ++source) {
    // The remainder, not a distribution: the standard leaves those to the library.
    if (k % block_length == 0) source = static_cast<std::size_t>(engine() % starts);
    sample.y[k] = fit.value(points.x[k]) + points.y[source] - fit.value(points.x[source]);
  }
  return sample;
}

Interval percentiles(std::vector<double> values, double confidence) {
  if (values.empty()) return {none, none};
  std::sort(values.begin(), values.end());
  const double tail = 0.5 * (1.0 - confidence) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(std::lround(tail));
  return {values[low], values[values.size() - 1 - low]};
}

void bootstrap(const SlopeCurve& curve, const Points& points, const ThresholdOptions& options,
               FailureThreshold& threshold) {
  std::mt19937_64 engine(options.seed);
  std::vector<double> breaks, resistances;
  for (int k = 0; k < options.resamples; ++k) {
    const auto fit = best_fit(resampled(points, threshold.fit, engine));
    if (!fit) continue;
    breaks.push_back(fit->break_point);
    resistances.push_back(interpolated(curve, fit->break_point));
  }
  threshold.resamples_found =
      static_cast<double>(breaks.size()) / static_cast<double>(std::max(options.resamples, 1));
  threshold.u_df_over_D_interval = percentiles(breaks, options.confidence);
  threshold.N_df_interval = percentiles(resistances, options.confidence);
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

double SlopeFit::value(double u_over_D) const {
  return value_at_start + descent * (std::min(u_over_D, break_point) - start) +
         drift * std::max(u_over_D - break_point, 0.0);
}

SlopeCurve slope_curve(std::span<const double> u_over_D, std::span<const double> N_d, double step) {
  check(u_over_D, N_d);
  SlopeCurve curve;
  curve.N_d = averaged(u_over_D, N_d, step);
  curve.slope.assign(curve.N_d.size(), none);
  for (std::size_t k = 0; k < curve.N_d.size(); ++k) {
    curve.u_over_D.push_back(step * (static_cast<double>(k) + 0.5));
    if (k < 2 || k + 2 >= curve.N_d.size()) continue;
    const double* y = &curve.N_d[k];
    curve.slope[k] = (2.0 * (y[2] - y[-2]) + y[1] - y[-1]) / (10.0 * step);
  }
  return curve;
}

FailureThreshold failure_threshold(const SlopeCurve& curve, const ThresholdOptions& options) {
  const double end = curve.u_over_D.empty() ? 0.0 : curve.u_over_D.back();
  const double half_step = curve.u_over_D.empty() ? 0.0 : curve.u_over_D.front();
  const double window = std::min(options.window, end + half_step);
  const Points points = points_to_fit(curve, window);
  const auto fit = best_fit(points);
  if (!fit) {
    return not_found(window, fmt::format("the slope shows no descending and stable segment in its "
                                         "{} points up to u/D = {:.3g}",
                                         points.x.size(), window));
  }
  const double before = fit->value_at_start;
  const double after = fit->value(0.5 * (fit->break_point + points.x.back()));
  if (after > (1.0 - options.smallest_fall) * before) {
    return not_found(window, fmt::format("the slope falls from {:.4g} to {:.4g} only, less than "
                                         "{:.0f} %",
                                         before, after, 100.0 * options.smallest_fall));
  }
  FailureThreshold threshold;
  threshold.found = true;
  threshold.window = window;
  threshold.fit = *fit;
  threshold.u_df_over_D = fit->break_point;
  threshold.N_df = interpolated(curve, fit->break_point);
  threshold.slope_before = before;
  threshold.slope_after = after;
  bootstrap(curve, points, options, threshold);
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
