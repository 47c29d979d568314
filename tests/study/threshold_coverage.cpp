// threshold_coverage CURVES [WINDOW]   prints how often the intervals of the failure threshold hold
//                                      the truth, for each kind of curve and scatter
#include <fmt/format.h>

#include <cstdlib>

#include "support/KnownCurves.hpp"

namespace mpm::support {
namespace {

constexpr std::uint64_t seed = 41;

void print_row(const std::string& family, const Scatter& scatter, double window, int curves) {
  const Coverage c = coverage(
      family, scatter, {.window = window, .tooth_period = scatter.tooth_period, .resamples = 200},
      curves, seed);
  const double n = c.found;
  fmt::print("{},{},{},{},{:.4g},{},{},{:.4g},{:.4g},{:.4g},{:.3g},{:.3g},{:.3g},{:.3g},{:.3g}\n",
             family, scatter.noise, scatter.correlation_length, scatter.teeth, scatter.tooth_period,
             window, c.curves, n / c.curves, c.u_covered / n, c.N_covered / n, c.u_errors / n,
             std::sqrt(c.u_squares / n), c.u_widths / n, std::sqrt(c.N_squares / n),
             c.N_widths / n);
  std::fflush(stdout);
}

void print_table(int curves, double window) {
  fmt::print(
      "family,noise,correlation_length,teeth,tooth_period,window,curves,found,u_covered,"
      "N_covered,u_bias,u_rms_error,u_width,N_rms_error,N_width\n");
  for (const char* family : {"corner", "peak"}) {
    for (const double teeth : {0.0, 0.015, 0.03}) {
      for (const double noise : {0.01, 0.02, 0.03}) {
        for (const double length : {0.01, 0.03}) {
          const double period = length < 0.02 ? 1.0 / 6.0 : 1.0 / 8.0;
          print_row(family, {noise, length, teeth, period}, window, curves);
        }
      }
    }
  }
}

}  // namespace
}  // namespace mpm::support

int main(int argc, char** argv) {
  mpm::support::print_table(argc > 1 ? std::atoi(argv[1]) : 400,
                            argc > 2 ? std::atof(argv[2]) : 0.75);
  return 0;
}
