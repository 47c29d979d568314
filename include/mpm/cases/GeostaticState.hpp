#pragma once

#include <functional>

#include "mpm/solver/Simulation.hpp"

namespace mpm::cases {

/// Soil at rest below a level surface at y = 0.
struct GeostaticStress {
  double unit_weight;  ///< gamma, N/m^3
  double K0;           ///< horizontal over vertical stress
};

/// sigma_v = gamma z and sigma_h = K0 sigma_v in both horizontal directions; tension positive, Pa.
std::function<SymmetricTensor(const Vector<2>&)> vertical_and_lateral(
    const GeostaticStress& stress);

/// How far the soil is from that state, over the particles where `counts` holds.
struct GeostaticErrors {
  double vertical_rms;  ///< of sigma_v - gamma z, as a share of the rms of gamma z
  double K0_rms;        ///< of sigma_h - K0 sigma_v, as a share of the rms of sigma_v
};

/// Collective.
GeostaticErrors measure_geostatic(const solver::Simulation<2>& simulation,
                                  const GeostaticStress& stress,
                                  const std::function<bool(const Vector<2>&)>& counts);

}  // namespace mpm::cases
