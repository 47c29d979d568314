#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mpm/analysis/CurveScatter.hpp"
#include "support/KnownCurves.hpp"

namespace mpm::support {
namespace {

constexpr Corner corner{.corner = 0.22, .rounding = 0.03, .first = 320.0, .last = 20.0};
constexpr Peak peak{.rise = {.corner = 0.2, .rounding = 0.03, .first = 380.0, .last = 5.0}};

analysis::FailureThreshold threshold_of(const Resistance& curve, const Scatter& scatter,
                                        const analysis::ThresholdOptions& options = {},
                                        std::uint64_t seed = 7) {
  std::mt19937_64 engine(seed);
  return read(rows(curve, scatter, engine), options);
}

/// Shares of many kinds of scatter together, as the nominal confidence is meant.
Coverage coverage_of(const std::string& family, double teeth, double confidence) {
  Coverage all;
  for (const double length : {0.01, 0.03}) {
    const Scatter scatter{0.02, length, teeth, length < 0.02 ? 1.0 / 6.0 : 1.0 / 8.0};
    const Coverage some = coverage(
        family, scatter,
        {.tooth_period = scatter.tooth_period, .resamples = 100, .confidence = confidence}, 60, 11);
    all.curves += some.curves;
    all.found += some.found;
    all.u_covered += some.u_covered;
    all.N_covered += some.N_covered;
  }
  return all;
}

// Of 120 curves with a true share of 93 to 97 %, 106 to 119 hold the truth in 97 % of cases or
// more. Half as wide intervals would hold it in about 70 %, twice as wide ones always.
void expect_right_intervals(const std::string& family, double teeth) {
  const Coverage c = coverage_of(family, teeth, 0.95);
  EXPECT_EQ(c.found, 120);
  EXPECT_GE(c.u_covered, 106);
  EXPECT_LE(c.u_covered, 119);
  EXPECT_GE(c.N_covered, 106);
  EXPECT_LE(c.N_covered, 119);
}

TEST(ThresholdInterval, holds_the_truth_of_rounded_corners_in_95_percent) {
  expect_right_intervals("corner", 0.0);
}

TEST(ThresholdInterval, holds_the_truth_of_peaks_in_95_percent) {
  expect_right_intervals("peak", 0.0);
}

TEST(ThresholdInterval, holds_the_truth_of_corners_with_saw_teeth_in_95_percent) {
  expect_right_intervals("corner", 0.03);
}

TEST(ThresholdInterval, holds_the_truth_of_peaks_with_saw_teeth_in_95_percent) {
  expect_right_intervals("peak", 0.03);
}

TEST(ThresholdInterval, of_half_confidence_misses_the_truth_in_a_third_of_cases_or_more) {
  const Coverage c = coverage_of("corner", 0.0, 0.5);
  EXPECT_GT(c.u_covered, 48);
  EXPECT_LT(c.u_covered, 80);
}

TEST(ThresholdInterval, is_narrow_on_a_curve_without_scatter) {
  const auto interval = threshold_of(corner, {}).u_df_over_D_interval;
  EXPECT_LT(interval.high - interval.low, 0.02);
}

TEST(ThresholdInterval, grows_with_the_scatter) {
  const auto width = [](double noise) {
    const auto interval = threshold_of(corner, {.noise = noise}).u_df_over_D_interval;
    return interval.high - interval.low;
  };
  EXPECT_GT(width(0.02), 2.0 * width(0.002));
}

TEST(Threshold, of_a_peak_lies_at_the_peak) {
  double top = 0.0;
  for (double u = 0.0; u < 0.9; u += 0.001) top = peak(u) > peak(top) ? u : top;
  const auto threshold = true_threshold(peak, 0.75);
  ASSERT_TRUE(threshold.found) << threshold.reason;
  EXPECT_NEAR(threshold.u_df_over_D, top, 0.04);
  EXPECT_GT(threshold.N_df, 0.95 * peak(top));
  EXPECT_EQ(threshold.slope_after, 0.0);
}

TEST(Threshold, of_a_peak_does_not_depend_on_the_window) {
  EXPECT_NEAR(true_threshold(peak, 0.75).u_df_over_D, true_threshold(peak, 0.9).u_df_over_D, 0.003);
}

TEST(Threshold, does_not_depend_on_how_long_the_slope_keeps_its_largest_value) {
  for (const double place : {0.12, 0.2, 0.3}) {
    const Corner sharp{.corner = place, .rounding = 0.03, .first = 320.0, .last = 20.0};
    EXPECT_NEAR(true_threshold(sharp, 0.75).u_df_over_D - place, 0.04, 0.012) << place;
  }
}

TEST(Threshold, of_a_staircase_is_that_of_the_curve_without_teeth) {
  const double truth = true_threshold(corner, 0.75).u_df_over_D;
  const double period = 1.0 / 6.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto read = threshold_of(corner, {0.0, 0.01, 0.03, period},
                                   {.tooth_period = period, .resamples = 0}, seed);
    EXPECT_NEAR(read.u_df_over_D, truth, 0.02) << seed;
  }
}

TEST(Threshold, is_not_read_where_the_slope_still_falls_at_the_end) {
  const auto threshold = true_threshold(Corner{.corner = 0.7, .rounding = 0.05}, 0.75);
  EXPECT_FALSE(threshold.found);
  EXPECT_NE(threshold.reason.find("still falls"), std::string::npos) << threshold.reason;
}

TEST(CurveScatter, takes_off_saw_teeth) {
  std::mt19937_64 engine(3);
  const double period = 1.0 / 8.0;
  const History history = rows(corner, {0.0, 0.01, 0.03, period}, engine);
  const auto curve = analysis::slope_curve(history.u_over_D, history.N_d);
  std::vector<double> shape;
  for (const double u : curve.u_over_D) shape.push_back(corner(u));
  const analysis::CurveScatter scatter(curve.N_d, shape, 0.01, period);
  double before = 0.0, after = 0.0;
  for (std::size_t k = 30; k < 85; ++k) {
    before += std::pow(curve.N_d[k] / shape[k] - 1.0, 2);
    after += std::pow(scatter.resistance()[k] / shape[k] - 1.0, 2);
  }
  EXPECT_NEAR(std::sqrt(before / 55.0), 0.03 / std::sqrt(3.0), 0.003);
  EXPECT_LT(after, 0.25 * before);
}

TEST(CurveScatter, draws_as_much_scatter_as_the_curve_has) {
  double ratio = 0.0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    std::mt19937_64 engine(seed);
    const History history = rows(corner, {.noise = 0.02, .correlation_length = 0.02}, engine);
    const auto curve = analysis::slope_curve(history.u_over_D, history.N_d);
    std::vector<double> shape;
    for (const double u : curve.u_over_D) shape.push_back(corner(u));
    const analysis::CurveScatter scatter(curve.N_d, shape, 0.01, 0.0);
    const std::vector<double> drawn = scatter.with_more(engine);
    double own = 0.0, added = 0.0;
    for (std::size_t k = 30; k < 85; ++k) {
      own += std::pow(curve.N_d[k] - shape[k], 2);
      added += std::pow(drawn[k] - curve.N_d[k], 2);
    }
    ratio += std::sqrt(added / own) / 30.0;
  }
  EXPECT_NEAR(ratio, 1.0, 0.25);
}

}  // namespace
}  // namespace mpm::support
