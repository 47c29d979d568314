#pragma once

#include <cmath>
#include <numbers>

#include "mpm/core/Tensor.hpp"

namespace mpm::contact {

/// Of a rigid body at one time.
template <int dim>
struct BodyVelocity {
  Vector<dim> translation{};  ///< m/s
  double spin = 0.0;          ///< rad/s, anticlockwise about the reference point, in the plane
};

/// How a rigid body moves, whatever acts on it.
template <int dim>
class Motion {
 public:
  virtual ~Motion() = default;
  /// `time` counts while the body is not held, s.
  virtual BodyVelocity<dim> at(double time) const = 0;
};

/// A speed that rises as V (1 - cos)/2 until the body has covered `distance`, then stays V.
struct Ramp {
  double velocity;  ///< V, m/s
  double distance;  ///< m

  double at(double time) const {
    const double end = 2.0 * distance / velocity;
    if (time >= end) return velocity;
    return 0.5 * velocity * (1.0 - std::cos(std::numbers::pi * time / end));
  }
};

/// Along a line, with the speed of a ramp.
template <int dim>
class RampMotion : public Motion<dim> {
 public:
  RampMotion(const Vector<dim>& unit_direction, const Ramp& ramp)
      : m_direction(unit_direction), m_ramp(ramp) {}

  BodyVelocity<dim> at(double time) const override {
    const double speed = m_ramp.at(time);
    BodyVelocity<dim> velocity;
    for (int d = 0; d < dim; ++d) velocity.translation[d] = m_direction[d] * speed;
    return velocity;
  }

 private:
  Vector<dim> m_direction;
  Ramp m_ramp;
};

}  // namespace mpm::contact
