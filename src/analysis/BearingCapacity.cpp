#include "mpm/analysis/BearingCapacity.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "mpm/core/Errors.hpp"

namespace mpm::analysis {

BearingFactors bearing_factors(double friction_angle) {
  if (!(friction_angle >= smallest_friction_angle && friction_angle <= largest_friction_angle)) {
    throw BadInput(fmt::format("bearing factors: friction angle {} degrees is outside {} to {}",
                               friction_angle, smallest_friction_angle, largest_friction_angle));
  }
  const double phi = friction_angle * std::numbers::pi / 180.0;
  const double flow = std::tan(std::numbers::pi / 4.0 + phi / 2.0);
  BearingFactors factors;
  factors.N_q = std::exp(std::numbers::pi * std::tan(phi)) * flow * flow;
  factors.N_gamma = std::exp(0.18 * friction_angle - 2.5);
  factors.N_c = (factors.N_q - 1.0) / std::tan(phi);
  return factors;
}

double bearing_resistance(const BuriedPipe& pipe, double friction_angle) {
  const BearingFactors factors = bearing_factors(friction_angle);
  const double overburden = pipe.unit_weight * pipe.embedment_ratio * pipe.diameter;
  return factors.N_q + factors.N_gamma / (2.0 * pipe.embedment_ratio) +
         factors.N_c * pipe.cohesion / overburden;
}

std::optional<double> back_calculated_friction_angle(const BuriedPipe& pipe, double N_d) {
  double low = smallest_friction_angle;
  double high = largest_friction_angle;
  // Written so that a NaN is out of range too.
  const bool in_range =
      N_d >= bearing_resistance(pipe, low) && N_d <= bearing_resistance(pipe, high);
  if (!in_range) return std::nullopt;
  while (high - low > 1e-9) {
    const double middle = 0.5 * (low + high);
    (bearing_resistance(pipe, middle) < N_d ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

SummaryValues bearing_summary(const BuriedPipe& pipe, double N_df) {
  SummaryValues values;
  BuriedPipe cohesionless = pipe;
  cohesionless.cohesion = 0.0;
  const std::pair<std::string, BuriedPipe> cases[] = {{"", cohesionless}, {"_cohesion", pipe}};
  for (const auto& [suffix, soil] : cases) {
    for (const int angle : {36, 39, 43}) {
      values.emplace_back(fmt::format("ala_N_d_phi{}{}", angle, suffix),
                          bearing_resistance(soil, angle));
    }
    values.emplace_back(fmt::format("ala_phi{}_deg", suffix),
                        back_calculated_friction_angle(soil, N_df)
                            .value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return values;
}

}  // namespace mpm::analysis
