#include "mpm/material/SandGap.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::material {

SandGap::SandGap(const SandParameters& sand)
    : m_closed(sand.pressure_floor),
      m_open(sand.gap_opening ? std::max(sand.pressure_floor, cohesion_shift(sand))
                              : sand.pressure_floor),
      m_opening(sand.gap_opening.value_or(1.0)) {}

double SandGap::p_star(double gap) const {
  return std::lerp(m_closed, m_open, std::min(1.0, (gap - 1.0) / m_opening));
}

}  // namespace mpm::material
