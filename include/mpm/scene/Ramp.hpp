#pragma once

#include <cmath>
#include <numbers>

namespace mpm::scene {

/// A velocity that rises as V (1 - cos)/2 until the body has covered `distance`, then stays V.
struct Ramp {
  double velocity;  ///< V, m/s
  double distance;  ///< m

  double at(double time) const {
    const double end = 2.0 * distance / velocity;
    if (time >= end) return velocity;
    return 0.5 * velocity * (1.0 - std::cos(std::numbers::pi * time / end));
  }
};

}  // namespace mpm::scene
