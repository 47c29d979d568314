#include "mpm/analysis/SlopeFit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>

#include "mpm/core/Errors.hpp"

namespace mpm::analysis {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double largest_from = 0.7;  ///< share of the largest slope where the fit starts
constexpr std::size_t fewest_descending_points = 5;
constexpr std::size_t fewest_stable_points = 10;
constexpr int refinement = 5;  ///< trials between two points

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

/// Sums over some of the points: of 1, x, x^2, y, x y, y^2.
struct Moments {
  double n = 0.0, x = 0.0, xx = 0.0, y = 0.0, xy = 0.0, yy = 0.0;

  void add(double at, double value) {
    n += 1.0;
    x += at;
    xx += at * at;
    y += value;
    xy += at * value;
    yy += value * value;
  }
  Moments operator-(const Moments& other) const {
    return {n - other.n, x - other.x, xx - other.xx, y - other.y, xy - other.xy, yy - other.yy};
  }
};

struct Candidate {
  SlopeFit fit;
  double residual = std::numeric_limits<double>::infinity();
};

/// The part of the slope curve that is fitted, with its running sums.
struct Points {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<Moments> before = {Moments{}};  ///< sums over the points before each

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
    before.push_back(before.back());
    before.back().add(at, value);
  }
  std::size_t number_up_to(double at) const {
    return static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  }
};

Points points_to_fit(const SlopeCurve& curve, double window) {
  const auto counts = [&](std::size_t k) {
    return !std::isnan(curve.slope[k]) && curve.u_over_D[k] <= window;
  };
  double largest = 0.0;
  for (std::size_t k = 0; k < curve.slope.size(); ++k) {
    if (counts(k)) largest = std::max(largest, curve.slope[k]);
  }
  Points points;
  for (std::size_t k = 0; k < curve.slope.size(); ++k) {
    const bool started = !points.x.empty() || curve.slope[k] >= largest_from * largest;
    if (started && counts(k)) points.add(curve.u_over_D[k], curve.slope[k]);
  }
  return points;
}

/// Least squares of the two slopes for given ends of the descent: y = largest (1 - t) + stable t
/// with t = 0 before, 1 behind, linear between.
Candidate fit_descent(const Points& points, double from, double to) {
  const std::size_t first = points.number_up_to(from);
  const std::size_t last = points.number_up_to(to);
  const Moments plateau = points.before[first];
  const Moments descent = points.before[last] - points.before[first];
  const Moments behind = points.before.back() - points.before[last];
  const double length = to - from;
  const double t = (descent.x - from * descent.n) / length;
  const double tt =
      (descent.xx - 2.0 * from * descent.x + from * from * descent.n) / (length * length);
  const double ty = (descent.xy - from * descent.y) / length;
  const double a = plateau.n + descent.n - 2.0 * t + tt, b = t - tt, c = tt + behind.n;
  const double p = plateau.y + descent.y - ty, q = ty + behind.y;

  Candidate result;
  SlopeFit& fit = result.fit;
  fit.start = points.x.front();
  fit.plateau_end = from;
  fit.break_point = to;
  fit.stable = std::max(0.0, (a * q - b * p) / (a * c - b * b));
  fit.largest = (p - b * fit.stable) / a;
  result.residual = points.before.back().yy - 2.0 * (fit.largest * p + fit.stable * q) +
                    a * fit.largest * fit.largest + 2.0 * b * fit.largest * fit.stable +
                    c * fit.stable * fit.stable;
  return result;
}

void keep_better(Candidate& best, const Candidate& other) {
  if (other.fit.largest > other.fit.stable && other.residual < best.residual) best = other;
}

/// Breaks at the points, then between them.
Candidate best_candidate(const Points& points) {
  const std::size_t last = points.x.size() - fewest_stable_points;
  Candidate best;
  for (std::size_t from = 0; from + fewest_descending_points <= last; ++from) {
    for (std::size_t to = from + fewest_descending_points; to <= last; ++to) {
      keep_better(best, fit_descent(points, points.x[from], points.x[to]));
    }
  }
  const double spacing = (points.x[1] - points.x[0]) / refinement;
  const SlopeFit coarse = best.fit;
  const double shortest = spacing * refinement * fewest_descending_points - 1e-9;
  for (int j = -refinement; j <= refinement; ++j) {
    const double from = std::max(coarse.plateau_end + j * spacing, points.x.front());
    for (int k = -refinement; k <= refinement; ++k) {
      const double to = std::min(coarse.break_point + k * spacing, points.x[last]);
      if (to - from >= shortest) keep_better(best, fit_descent(points, from, to));
    }
  }
  return best;
}

}  // namespace

double SlopeFit::value(double u_over_D) const {
  const double t = (u_over_D - plateau_end) / (break_point - plateau_end);
  return largest + (stable - largest) * std::clamp(t, 0.0, 1.0);
}

std::vector<double> slopes_of_steps(std::span<const double> N_d, double step) {
  std::vector<double> slopes(N_d.size(), none);
  for (std::size_t k = 2; k + 2 < N_d.size(); ++k) {
    slopes[k] = (2.0 * (N_d[k + 2] - N_d[k - 2]) + N_d[k + 1] - N_d[k - 1]) / (10.0 * step);
  }
  return slopes;
}

SlopeCurve slope_curve(std::span<const double> u_over_D, std::span<const double> N_d, double step) {
  check(u_over_D, N_d);
  SlopeCurve curve;
  curve.N_d = averaged(u_over_D, N_d, step);
  curve.slope = slopes_of_steps(curve.N_d, step);
  for (std::size_t k = 0; k < curve.N_d.size(); ++k) {
    curve.u_over_D.push_back(step * (static_cast<double>(k) + 0.5));
  }
  return curve;
}

SlopeReading read_slope(const SlopeCurve& curve, double window) {
  const Points points = points_to_fit(curve, window);
  if (points.x.size() < fewest_descending_points + fewest_stable_points + 1) {
    return {.reason = fmt::format("the slope curve has {} points from its largest slope to u/D = "
                                  "{:.3g}, too few for a descending and a stable segment",
                                  points.x.size(), window)};
  }
  const Candidate best = best_candidate(points);
  if (std::isinf(best.residual)) {
    return {.reason = fmt::format("the slope does not fall up to u/D = {:.3g}", window)};
  }
  const double last = points.x[points.x.size() - fewest_stable_points];
  if (best.fit.break_point >= last - 1e-9) {
    return {.reason = fmt::format("the slope still falls at u/D = {:.3g}, there is no stable "
                                  "segment yet",
                                  window)};
  }
  return {.found = true, .fit = best.fit};
}

}  // namespace mpm::analysis
