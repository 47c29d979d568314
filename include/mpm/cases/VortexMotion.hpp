#pragma once

#include <cmath>
#include <numbers>

#include "mpm/core/Tensor.hpp"

namespace mpm::cases {

/// The generalised vortex: every circle of a ring about the origin turns by its own angle
/// alpha(R, t) = A sin(pi t/T) h(R), h = 1 - 32 (R-1)^2 + 256 (R-1)^4, R in m. h and h' vanish at
/// R = 0.75 and 1.25, where the ring is thus at rest and free of traction.
struct VortexMotion {
  static constexpr double inner_radius = 0.75, outer_radius = 1.25;  // m

  double amplitude;            ///< A, radians
  double half_period;          ///< T, s
  double shear_speed_squared;  ///< mu/rho, m^2/s^2

  double angle(double R, double t) const { return amplitude * swing(t) * profile(R); }
  double angular_velocity(double R, double t) const {
    return amplitude * frequency() * std::cos(frequency() * t) * profile(R);
  }

  /// Where X is at time t, m.
  Vector<2> position(const Vector<2>& X, double t) const {
    const double alpha = angle(std::hypot(X[0], X[1]), t);
    const double c = std::cos(alpha), s = std::sin(alpha);
    return {c * X[0] - s * X[1], s * X[0] + c * X[1]};
  }
  Vector<2> displacement(const Vector<2>& X, double t) const {
    const Vector<2> x = position(X, t);
    return {x[0] - X[0], x[1] - X[1]};
  }
  Vector<2> velocity(const Vector<2>& X, double t) const {
    const Vector<2> x = position(X, t);
    const double rate = angular_velocity(std::hypot(X[0], X[1]), t);
    return {-rate * x[1], rate * x[0]};
  }

  /// The force per mass that makes the motion exact in a neo-Hookean solid, m/s^2. With
  /// g = R alpha', sigma = mu (b - 1) has the components sigma_rt = mu g and sigma_tt = mu g^2 and
  /// J = 1; the acceleration is (-R alpha_t^2, R alpha_tt).
  Vector<2> body_force(const Vector<2>& X, double t) const {
    const double R = std::hypot(X[0], X[1]);
    const double rate = angular_velocity(R, t);
    const double slope = amplitude * swing(t) * profile_slope(R);
    const double curvature = amplitude * swing(t) * profile_curvature(R);
    const double radial = -R * rate * rate + shear_speed_squared * R * slope * slope;
    const double tangential = -R * frequency() * frequency() * angle(R, t) -
                              shear_speed_squared * (3.0 * slope + R * curvature);
    const Vector<2> x = position(X, t);
    return {(radial * x[0] - tangential * x[1]) / R, (radial * x[1] + tangential * x[0]) / R};
  }

 private:
  double frequency() const { return std::numbers::pi / half_period; }
  double swing(double t) const { return std::sin(frequency() * t); }
  static double profile(double R) {
    const double s2 = (R - 1.0) * (R - 1.0);
    return 1.0 - 32.0 * s2 + 256.0 * s2 * s2;
  }
  static double profile_slope(double R) {
    const double s = R - 1.0;
    return -64.0 * s + 1024.0 * s * s * s;
  }
  static double profile_curvature(double R) { return -64.0 + 3072.0 * (R - 1.0) * (R - 1.0); }
};

}  // namespace mpm::cases
