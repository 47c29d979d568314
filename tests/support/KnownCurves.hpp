#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "mpm/analysis/FailureThreshold.hpp"

/// Resistance curves whose threshold is known, with scatter as runs have it.
namespace mpm::support {

struct History {
  std::vector<double> u_over_D;
  std::vector<double> N_d;
};

/// N_d of u/D without scatter.
using Resistance = std::function<double(double)>;

inline double uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * (static_cast<double>(engine() >> 11) + 0.5) * 0x1.0p-53;
}

inline double normal(std::mt19937_64& engine) {
  const double radius = std::sqrt(-2.0 * std::log(uniform(engine, 0.0, 1.0)));
  return radius * std::cos(uniform(engine, 0.0, 6.283185307179586));
}

/// Two straight lines with a rounded corner: dN_d/d(u/D) falls from `first` to `last` like
/// 1 - tanh((u - corner)/rounding).
struct Corner {
  double corner = 0.2;
  double rounding = 0.04;
  double first = 320.0;
  double last = 20.0;

  double operator()(double u) const {
    const auto log_cosh = [](double x) {
      return std::abs(x) + std::log1p(std::exp(-2.0 * std::abs(x)));
    };
    const double beyond =
        rounding * (log_cosh((u - corner) / rounding) - log_cosh(corner / rounding));
    return last * u + 0.5 * (first - last) * (u - beyond);
  }
};

/// The rounded corner, and past it a loss of `softening` of the resistance around u/D = `middle`.
struct Peak {
  Corner rise;
  double softening = 0.25;
  double middle = 0.35;
  double reach = 0.05;

  double operator()(double u) const {
    return rise(u) * (1.0 - 0.5 * softening * (1.0 + std::tanh((u - middle) / reach)));
  }
};

/// A curve of the family "corner" or "peak" with dimensions drawn at random.
inline Resistance random_curve(const std::string& family, std::mt19937_64& engine) {
  Corner rise{.corner = uniform(engine, 0.15, 0.30),
              .rounding = uniform(engine, 0.02, 0.06),
              .first = uniform(engine, 250.0, 600.0),
              .last = uniform(engine, 0.0, 60.0)};
  if (family == "corner") return rise;
  rise.last = uniform(engine, 0.0, 20.0);
  return Peak{.rise = rise,
              .softening = uniform(engine, 0.1, 0.3),
              .middle = rise.corner + uniform(engine, 0.12, 0.2),
              .reach = uniform(engine, 0.03, 0.06)};
}

struct Scatter {
  double noise = 0.0;                ///< standard deviation over N_d
  double correlation_length = 0.01;  ///< in u/D, of exponential correlation
  double teeth = 0.0;                ///< half of a saw-tooth's height over N_d
  double tooth_period = 1.0 / 6.0;   ///< in u/D
};

/// Rows as history.csv has them; teeth begin anywhere and lean to either side.
inline History rows(const Resistance& curve, const Scatter& scatter, std::mt19937_64& engine,
                    double end = 0.9, double spacing = 0.0025) {
  const double memory = std::exp(-spacing / scatter.correlation_length);
  const double phase = uniform(engine, 0.0, 1.0);
  const double lean = uniform(engine, 0.0, 1.0) < 0.5 ? -1.0 : 1.0;
  double noise = normal(engine);
  History history;
  for (int k = 1; k <= static_cast<int>(std::lround(end / spacing)); ++k) {
    const double u = spacing * (k - 0.5);
    const double turns = scatter.teeth > 0.0 ? u / scatter.tooth_period + phase : 0.0;
    const double tooth = lean * (2.0 * (turns - std::floor(turns)) - 1.0);
    history.u_over_D.push_back(spacing * k);
    history.N_d.push_back(curve(u) * (1.0 + scatter.noise * noise + scatter.teeth * tooth));
    noise = memory * noise + std::sqrt(1.0 - memory * memory) * normal(engine);
  }
  return history;
}

inline analysis::FailureThreshold read(const History& history,
                                       const analysis::ThresholdOptions& options) {
  return analysis::failure_threshold(analysis::slope_curve(history.u_over_D, history.N_d), options);
}

/// The threshold of the curve itself: what the reading gives without scatter.
inline analysis::FailureThreshold true_threshold(const Resistance& curve, double window) {
  std::mt19937_64 unused(1);
  return read(rows(curve, {}, unused), {.window = window, .resamples = 0});
}

struct Coverage {
  int curves = 0;  ///< with a true threshold
  int found = 0;
  int u_covered = 0;                                       ///< intervals that hold the true u_df/D
  int N_covered = 0;                                       ///< intervals that hold the true N_df
  double u_squares = 0.0, u_errors = 0.0, u_widths = 0.0;  ///< sums over those found
  double N_squares = 0.0, N_widths = 0.0;                  ///< the same of N_df over its truth
};

inline bool holds(const analysis::Interval& interval, double value) {
  return interval.low <= value && value <= interval.high;
}

/// Reads many random curves of a family and counts how often the intervals hold the truth.
inline Coverage coverage(const std::string& family, const Scatter& scatter,
                         const analysis::ThresholdOptions& options, int curves,
                         std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  Coverage result;
  for (int k = 0; k < curves; ++k) {
    const Resistance curve = random_curve(family, engine);
    const auto truth = true_threshold(curve, options.window);
    const auto threshold = read(rows(curve, scatter, engine), options);
    result.curves += truth.found ? 1 : 0;
    if (!truth.found || !threshold.found) continue;
    const double u_error = threshold.u_df_over_D - truth.u_df_over_D;
    const double N_error = threshold.N_df / truth.N_df - 1.0;
    const auto &u = threshold.u_df_over_D_interval, &N = threshold.N_df_interval;
    result.found += 1;
    result.u_covered += holds(u, truth.u_df_over_D) ? 1 : 0;
    result.N_covered += holds(N, truth.N_df) ? 1 : 0;
    result.u_errors += u_error;
    result.u_squares += u_error * u_error;
    result.u_widths += u.high - u.low;
    result.N_squares += N_error * N_error;
    result.N_widths += (N.high - N.low) / truth.N_df;
  }
  return result;
}

}  // namespace mpm::support
