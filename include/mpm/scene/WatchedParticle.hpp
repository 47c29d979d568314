#pragma once

#include <cstdint>
#include <vector>

#include "mpm/particles/Particles.hpp"

namespace mpm::scene {

/// One particle that is followed through the run, wherever it goes.
class WatchedParticle {
 public:
  /// The particle nearest to x. Collective.
  WatchedParticle(const particles::Particles<2>& particles, const Vector<2>& x);

  /// q, p, volumetric strain, void ratio, eps_q; compression positive. Collective.
  std::vector<double> observe(const particles::Particles<2>& particles) const;

 private:
  std::int64_t m_id = 0;
  double m_initial_volume = 0.0;
};

}  // namespace mpm::scene
