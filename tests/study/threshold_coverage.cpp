// threshold_coverage CURVES        how often the intervals of the failure threshold hold the truth,
//                                  for each kind of curve and scatter, as CSV
// threshold_coverage examples      some of the curves, row by row, with their thresholds, as CSV
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/KnownCurves.hpp"

namespace mpm::support {
namespace {

constexpr std::uint64_t seed = 41;

void print_row(const std::string& family, const Scatter& scatter, double window, int curves) {
  const Coverage c = coverage(
      family, scatter, {.window = window, .tooth_period = scatter.tooth_period, .resamples = 200},
      curves, seed);
  const double n = c.found;
  fmt::print("{},{},{},{},{:.4g},{},{},{:.3f},{:.3f},{:.3f},{:.2g},{:.3g},{:.3g},{:.3g},{:.3g}\n",
             family, scatter.noise, scatter.correlation_length, scatter.teeth, scatter.tooth_period,
             window, c.curves, n / c.curves, c.u_covered / n, c.N_covered / n, c.u_errors / n,
             std::sqrt(c.u_squares / n), c.u_widths / n, std::sqrt(c.N_squares / n),
             c.N_widths / n);
  std::fflush(stdout);
}

void print_rows(const std::string& family, double window, int curves) {
  for (const double teeth : {0.0, 0.015, 0.03}) {
    for (const double noise : {0.01, 0.02, 0.03}) {
      print_row(family, {noise, 0.01, teeth, 1.0 / 6.0}, window, curves);
      print_row(family, {noise, 0.03, teeth, 1.0 / 8.0}, window, curves);
    }
  }
}

void print_table(int curves) {
  fmt::print(
      "family,noise,correlation_length,teeth,tooth_period,window,curves,found,u_covered,"
      "N_covered,u_bias,u_rms_error,u_width,N_rms_error,N_width\n");
  for (const double window : {0.75, 0.9}) {
    for (const char* family : {"corner", "peak"}) print_rows(family, window, curves);
  }
}

void print_example(const std::string& name, const Resistance& curve, const Scatter& scatter) {
  std::mt19937_64 engine(seed);
  const History history = rows(curve, scatter, engine);
  const auto truth = true_threshold(curve, 0.75);
  const auto threshold = read(history, {.tooth_period = scatter.tooth_period});
  const auto &u = threshold.u_df_over_D_interval, &N = threshold.N_df_interval;
  for (std::size_t k = 0; k < history.N_d.size(); ++k) {
    fmt::print("{},{:.5g},{:.5g},{:.5g},{},{},{},{},{},{},{},{}\n", name, history.u_over_D[k],
               history.N_d[k], curve(history.u_over_D[k]), truth.u_df_over_D, truth.N_df,
               threshold.u_df_over_D, threshold.N_df, u.low, u.high, N.low, N.high);
  }
}

void print_examples() {
  const Corner corner{.corner = 0.22, .rounding = 0.04, .first = 320.0, .last = 20.0};
  const Peak peak{.rise = {.corner = 0.2, .rounding = 0.03, .first = 380.0, .last = 5.0}};
  fmt::print("curve,u_over_D,N_d,without_scatter,true_u,true_N,u,N,u_low,u_high,N_low,N_high\n");
  print_example("corner", corner, {.noise = 0.02, .correlation_length = 0.02, .tooth_period = 0.0});
  print_example("peak", peak, {.noise = 0.02, .correlation_length = 0.02, .tooth_period = 0.0});
  print_example("corner with teeth", corner, {0.01, 0.02, 0.03, 1.0 / 6.0});
  print_example("peak with teeth", peak, {0.01, 0.02, 0.03, 1.0 / 6.0});
}

}  // namespace
}  // namespace mpm::support

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "examples") {
    mpm::support::print_examples();
    return 0;
  }
  const int curves = argc == 2 ? std::atoi(argv[1]) : 0;
  if (curves <= 0) {
    fmt::print(stderr, "usage: threshold_coverage CURVES | examples\n");
    return 2;
  }
  mpm::support::print_table(curves);
  return 0;
}
