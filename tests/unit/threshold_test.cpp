#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "mpm/analysis/BearingCapacity.hpp"
#include "mpm/analysis/FailureThreshold.hpp"
#include "mpm/core/Errors.hpp"

namespace mpm::analysis {
namespace {

struct Curve {
  std::vector<double> u_over_D;
  std::vector<double> N_d;
};

/// Rows as history.csv has them: the mean of a curve over each interval, from its integral.
Curve rows(const std::function<double(double)>& integral, double end, double spacing = 0.0025) {
  Curve curve;
  for (int k = 1; k <= static_cast<int>(std::lround(end / spacing)); ++k) {
    curve.u_over_D.push_back(spacing * k);
    curve.N_d.push_back((integral(spacing * k) - integral(spacing * (k - 1))) / spacing);
  }
  return curve;
}

/// Integral of the N_d whose slope falls linearly from `first` at 0 to `last` at the knee.
std::function<double(double)> knee_at(double knee, double first, double last) {
  return [=](double u) {
    const double bent = std::min(u, knee);
    const double curvature = (last - first) / knee;
    const double N_d_knee = first * knee + 0.5 * curvature * knee * knee;
    const double beyond = u - bent;
    return first * bent * bent / 2.0 + curvature * bent * bent * bent / 6.0 + N_d_knee * beyond +
           last * beyond * beyond / 2.0;
  };
}

FailureThreshold threshold_of(const Curve& curve, const ThresholdOptions& options = {}) {
  return failure_threshold(slope_curve(curve.u_over_D, curve.N_d), options);
}

Curve with_noise(Curve curve, double amplitude) {
  std::mt19937_64 engine(3);
  for (double& N_d : curve.N_d) {
    N_d += amplitude * (2.0 * static_cast<double>(engine()) / 18446744073709551616.0 - 1.0);
  }
  return curve;
}

TEST(BearingCapacity, gives_the_guidelines_values) {
  const BuriedPipe shallow{.diameter = 0.5, .embedment_ratio = 3.0, .unit_weight = 17000.0};
  EXPECT_NEAR(bearing_resistance(shallow, 36.0), 46.7, 0.05);
  EXPECT_NEAR(bearing_resistance(shallow, 39.0), 71.3, 0.05);
  EXPECT_NEAR(bearing_resistance(shallow, 43.0), 130.5, 0.05);
  BuriedPipe deep = shallow;
  deep.embedment_ratio = 8.0;
  EXPECT_NEAR(bearing_resistance(deep, 36.0), 41.1, 0.05);
  EXPECT_NEAR(bearing_resistance(deep, 39.0), 61.7, 0.05);
  EXPECT_NEAR(bearing_resistance(deep, 43.0), 110.8, 0.05);
}

TEST(BearingCapacity, cohesion_matters_for_small_pipes_only) {
  const double unit_weight = 2.65 * 1000.0 * 9.81 / (1.0 + 0.524);
  BuriedPipe pipe{0.0375, 3.0, unit_weight, 1000.0};
  BuriedPipe bare = pipe;
  bare.cohesion = 0.0;
  const auto gain = [&](double angle) {
    return bearing_resistance(pipe, angle) - bearing_resistance(bare, angle);
  };
  EXPECT_NEAR(gain(36.0), 26.0, 0.5);
  EXPECT_NEAR(gain(43.0), 55.0, 0.5);
  pipe.diameter = bare.diameter = 0.5;
  EXPECT_NEAR(gain(36.0), 2.0, 0.5);
  EXPECT_NEAR(gain(43.0), 4.0, 0.5);
}

TEST(BearingCapacity, back_calculation_inverts_the_formula) {
  const BuriedPipe pipe{0.15, 4.0, 16500.0, 800.0};
  for (const double angle : {2.5, 36.7, 43.0, 58.0}) {
    const auto found = back_calculated_friction_angle(pipe, bearing_resistance(pipe, angle));
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(*found, angle, 1e-6);
  }
}

TEST(BearingCapacity, back_calculation_gives_none_out_of_range) {
  const BuriedPipe pipe{0.15, 4.0, 16500.0, 0.0};
  EXPECT_FALSE(back_calculated_friction_angle(pipe, 0.4).has_value());
  EXPECT_FALSE(back_calculated_friction_angle(pipe, 1e6).has_value());
  EXPECT_FALSE(back_calculated_friction_angle(pipe, std::nan("")).has_value());
}

TEST(BearingCapacity, refuses_angles_without_meaning) {
  EXPECT_THROW(bearing_factors(-3.0), BadInput);
  EXPECT_THROW(bearing_factors(75.0), BadInput);
  EXPECT_THROW(bearing_factors(std::nan("")), BadInput);
}

TEST(BearingCapacity, summary_back_calculates_with_and_without_cohesion) {
  const BuriedPipe pipe{0.0375, 3.0, 17058.0, 1000.0};
  const auto values = bearing_summary(pipe, bearing_resistance(pipe, 41.0));
  const auto value = [&](const std::string& key) {
    const auto entry = std::find_if(values.begin(), values.end(),
                                    [&](const auto& pair) { return pair.first == key; });
    return entry == values.end() ? std::nan("") : entry->second;
  };
  EXPECT_NEAR(value("ala_phi_cohesion_deg"), 41.0, 1e-6);
  EXPECT_GT(value("ala_phi_deg"), 42.0);
  EXPECT_NEAR(value("ala_N_d_phi36"), 46.7, 0.05);
  EXPECT_NEAR(value("ala_N_d_phi36_cohesion"), 46.7 + 26.0, 0.5);
}

TEST(SlopeCurve, is_exact_for_a_quadratic) {
  const auto integral = [](double u) { return 300.0 * u * u / 2.0 - 120.0 * u * u * u / 3.0; };
  for (const double spacing : {0.0025, 0.004, 0.01, 0.02}) {
    const Curve curve = rows(integral, 0.6, spacing);
    const auto slopes = slope_curve(curve.u_over_D, curve.N_d);
    ASSERT_EQ(slopes.slope.size(), 60u);
    EXPECT_TRUE(std::isnan(slopes.slope[1]));
    EXPECT_TRUE(std::isnan(slopes.slope[58]));
    if (spacing == 0.0025 || spacing == 0.01) {
      EXPECT_NEAR(slopes.slope[20], 300.0 - 240.0 * slopes.u_over_D[20], 1e-8);
      EXPECT_NEAR(slopes.N_d[20], (integral(0.21) - integral(0.20)) / 0.01, 1e-10);
    }
  }
}

TEST(SlopeCurve, is_the_least_squares_quadratic_on_five_steps) {
  // Of x^3 the fit gives 3 x^2 + 3.4 h^2, and the means over steps add h^2/4.
  const Curve curve = rows([](double u) { return 1e4 * u * u * u * u / 4.0; }, 0.4);
  const auto slopes = slope_curve(curve.u_over_D, curve.N_d);
  const double x = slopes.u_over_D[12];
  EXPECT_NEAR(slopes.slope[12] / 1e4, 3.0 * x * x + 3.65e-4, 1e-9);
}

TEST(SlopeCurve, leaves_out_a_last_step_covered_by_less_than_half) {
  const Curve curve = rows([](double u) { return 40.0 * u * u; }, 0.3525);
  EXPECT_EQ(slope_curve(curve.u_over_D, curve.N_d).N_d.size(), 35u);
  const Curve longer = rows([](double u) { return 40.0 * u * u; }, 0.3575);
  EXPECT_EQ(slope_curve(longer.u_over_D, longer.N_d).N_d.size(), 36u);
}

TEST(SlopeCurve, refuses_what_is_no_curve) {
  const std::vector<double> u = {0.1, 0.2, 0.15}, N_d = {2.0, 3.0, 4.0};
  EXPECT_THROW(slope_curve(u, N_d), BadInput);
  EXPECT_THROW(slope_curve(std::span(u).first(2), N_d), BadInput);
  const std::vector<double> bad = {2.0, std::nan("")};
  EXPECT_THROW(slope_curve(std::span(u).first(2), bad), BadInput);
}

TEST(SlopeCurve, of_nothing_is_empty) {
  const auto curve = slope_curve({}, {});
  EXPECT_TRUE(curve.N_d.empty());
  EXPECT_FALSE(failure_threshold(curve).found);
}

TEST(FailureThreshold, is_the_known_knee_of_the_slope) {
  for (const double knee : {0.12, 0.21, 0.33}) {
    const auto threshold = threshold_of(rows(knee_at(knee, 620.0, 140.0), 0.95));
    ASSERT_TRUE(threshold.found) << threshold.reason;
    EXPECT_NEAR(threshold.u_df_over_D, knee, 0.004);
    EXPECT_NEAR(threshold.N_df, 0.5 * (620.0 + 140.0) * knee, 0.02 * threshold.N_df);
    EXPECT_NEAR(threshold.slope_before, 620.0 - 480.0 * 0.025 / knee, 12.0);
    EXPECT_NEAR(threshold.slope_after, 140.0, 2.0);
    EXPECT_DOUBLE_EQ(threshold.window, 0.75);
  }
}

TEST(FailureThreshold, of_a_broken_line_lies_at_its_corner) {
  const double knee = 0.27;
  const auto integral = [=](double u) {
    const double beyond = std::max(u - knee, 0.0);
    return 480.0 * u * u / 2.0 - 330.0 * beyond * beyond / 2.0;
  };
  const auto threshold = threshold_of(rows(integral, 0.9));
  ASSERT_TRUE(threshold.found) << threshold.reason;
  EXPECT_NEAR(threshold.u_df_over_D, knee, 0.03);
  EXPECT_NEAR(threshold.slope_after, 150.0, 3.0);
}

TEST(FailureThreshold, interval_holds_the_knee_under_noise) {
  const double knee = 0.24;
  const auto threshold = threshold_of(with_noise(rows(knee_at(knee, 620.0, 140.0), 0.9), 1.5));
  ASSERT_TRUE(threshold.found) << threshold.reason;
  EXPECT_NEAR(threshold.u_df_over_D, knee, 0.05);
  EXPECT_LT(threshold.u_df_over_D_interval.low, knee);
  EXPECT_GT(threshold.u_df_over_D_interval.high, knee);
  EXPECT_LE(threshold.N_df_interval.low, threshold.N_df);
  EXPECT_GE(threshold.N_df_interval.high, threshold.N_df);
  EXPECT_GT(threshold.resamples_found, 0.9);
  const auto narrow =
      threshold_of(with_noise(rows(knee_at(knee, 620.0, 140.0), 0.9), 1.5), {.confidence = 0.5})
          .u_df_over_D_interval;
  EXPECT_GT(narrow.low, threshold.u_df_over_D_interval.low);
  EXPECT_LT(narrow.high, threshold.u_df_over_D_interval.high);
}

TEST(FailureThreshold, interval_grows_with_the_noise) {
  const auto width = [](double amplitude) {
    const auto interval =
        threshold_of(with_noise(rows(knee_at(0.24, 620.0, 140.0), 0.9), amplitude))
            .u_df_over_D_interval;
    return interval.high - interval.low;
  };
  EXPECT_GT(width(1.5), 2.0 * width(0.2));
}

TEST(FailureThreshold, is_the_same_every_time) {
  const Curve curve = with_noise(rows(knee_at(0.24, 620.0, 140.0), 0.9), 0.8);
  const auto first = threshold_of(curve);
  const auto second = threshold_of(curve);
  EXPECT_EQ(first.u_df_over_D_interval.low, second.u_df_over_D_interval.low);
  EXPECT_EQ(first.N_df_interval.high, second.N_df_interval.high);
  const auto other_seed = threshold_of(curve, {.seed = 5});
  EXPECT_EQ(first.u_df_over_D, other_seed.u_df_over_D);
}

TEST(FailureThreshold, needs_the_slope_to_fall_by_thirty_percent) {
  EXPECT_FALSE(threshold_of(rows(knee_at(0.25, 400.0, 300.0), 0.9)).found);
  EXPECT_TRUE(threshold_of(rows(knee_at(0.25, 400.0, 240.0), 0.9)).found);
  const auto none = threshold_of(rows(knee_at(0.25, 400.0, 300.0), 0.9));
  EXPECT_NE(none.reason.find("30 %"), std::string::npos);
  EXPECT_TRUE(std::isnan(none.N_df));
}

TEST(FailureThreshold, is_not_seen_in_a_straight_line) {
  EXPECT_FALSE(threshold_of(rows([](double u) { return 250.0 * u * u / 2.0; }, 0.9)).found);
  const auto noisy = with_noise(rows([](double u) { return 250.0 * u * u / 2.0; }, 0.9), 0.5);
  EXPECT_FALSE(threshold_of(noisy).found);
}

TEST(FailureThreshold, is_not_seen_where_the_slope_only_grows) {
  EXPECT_FALSE(threshold_of(rows([](double u) { return 90.0 * u * u * u; }, 0.9)).found);
}

TEST(FailureThreshold, is_not_seen_where_the_slope_falls_ever_faster) {
  const auto integral = [](double u) {
    const double late = std::max(u - 0.4, 0.0);
    return 250.0 * u * u - 75.0 * u * u * u / 6.0 - 900.0 * late * late * late / 6.0;
  };
  EXPECT_FALSE(threshold_of(rows(integral, 0.9)).found);
}

TEST(FailureThreshold, says_that_a_curve_is_too_short) {
  const auto threshold = threshold_of(rows(knee_at(0.21, 620.0, 140.0), 0.08));
  EXPECT_FALSE(threshold.found);
  EXPECT_NEAR(threshold.window, 0.08, 1e-12);
  EXPECT_NE(threshold.reason.find("4 points"), std::string::npos) << threshold.reason;
}

TEST(FailureThreshold, uses_the_window_that_there_is) {
  const Curve curve = rows(knee_at(0.12, 620.0, 140.0), 0.3);
  const auto threshold = threshold_of(curve, {.window = 0.9});
  ASSERT_TRUE(threshold.found) << threshold.reason;
  EXPECT_NEAR(threshold.window, 0.3, 1e-12);
  EXPECT_NEAR(threshold.u_df_over_D, 0.12, 0.005);
}

TEST(FailureThreshold, looks_no_further_than_its_window) {
  const auto integral = [](double u) {
    const double late = std::max(u - 0.5, 0.0);
    return knee_at(0.2, 620.0, 140.0)(u) + 800.0 * late * late * late / 6.0;
  };
  const Curve curve = rows(integral, 0.9);
  EXPECT_NEAR(threshold_of(curve, {.window = 0.5}).u_df_over_D, 0.2, 0.004);
  EXPECT_GT(threshold_of(curve, {.window = 0.9}).slope_after, 200.0);
}

TEST(FailureThreshold, table_has_a_fit_for_each_window) {
  const Curve curve = rows(knee_at(0.2, 620.0, 140.0), 0.9);
  const auto slopes = slope_curve(curve.u_over_D, curve.N_d);
  const std::vector<FailureThreshold> thresholds = {failure_threshold(slopes, {.window = 0.75}),
                                                    failure_threshold(slopes, {.window = 0.9})};
  const std::string table = threshold_csv(slopes, thresholds);
  EXPECT_EQ(table.substr(0, table.find('\n')), "u_over_D,N_d,slope,fit_to_0.75,fit_to_0.9");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 91);
  const auto last_row = table.substr(table.rfind('\n', table.size() - 2) + 1);
  EXPECT_NE(last_row.find("nan,nan,"), std::string::npos) << last_row;
}

}  // namespace
}  // namespace mpm::analysis
