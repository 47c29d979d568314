#pragma once

#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// The mean stress of an open gap, a function of J_gap alone: what is left of the cohesion where
/// the pressure floor opens a gap fades with the opening, comes back on closing, and does no work
/// in a cycle. No deviator.
class SandGap {
 public:
  explicit SandGap(const SandParameters& sand);

  /// p* at J_gap >= 1: the floor where the gap is closed, p_c (no stress) from the opening on.
  double p_star(double gap) const;

 private:
  double m_closed, m_open;  ///< p*, Pa
  double m_opening;
};

}  // namespace mpm::material
