#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mpm::analysis {

/// Numbers of an analysis under the key that summary.json gives them; NaN where there is none.
using SummaryValues = std::vector<std::pair<std::string, double>>;

/// The pipe and the soil around it as the guideline sees them.
struct BuriedPipe {
  double diameter = 0.0;         ///< D, m
  double embedment_ratio = 0.0;  ///< H/D, H the depth of the springline
  double unit_weight = 0.0;      ///< gamma, N/m3
  double cohesion = 0.0;         ///< c, Pa
};

/// Bearing factors of ALA (2005), each dimensionless.
struct BearingFactors {
  double N_q = 0.0;      ///< exp(pi tan phi) tan^2(45 + phi/2)  (28)
  double N_gamma = 0.0;  ///< exp(0.18 phi - 2.5), phi in degrees  (29)
  double N_c = 0.0;      ///< (N_q - 1) cot phi
};

/// Friction angles between which the factors are used, degrees; N_c is 0/0 at phi = 0.
inline constexpr double smallest_friction_angle = 1.0;
inline constexpr double largest_friction_angle = 60.0;

/// Throws BadInput for an angle (degrees) outside the two limits.
BearingFactors bearing_factors(double friction_angle);

/// N_d = Q/(gamma H D) = N_q + N_gamma/(2 H/D) + N_c c/(gamma H) (27), friction angle in degrees.
double bearing_resistance(const BuriedPipe& pipe, double friction_angle);

/// The friction angle (degrees) at which the formula gives N_d, to 1e-9 degrees; none when N_d is
/// not reached between the two limits.
std::optional<double> back_calculated_friction_angle(const BuriedPipe& pipe, double N_d);

/// ala_N_d_phi36, _phi39, _phi43 (without cohesion), the same with `_cohesion`, and the angles
/// ala_phi_deg and ala_phi_cohesion_deg back-calculated from N_df (NaN: none).
SummaryValues bearing_summary(const BuriedPipe& pipe, double N_df);

}  // namespace mpm::analysis
