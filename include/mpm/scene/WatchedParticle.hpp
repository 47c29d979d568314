#pragma once

#include <cstdint>
#include <vector>

#include "mpm/particles/Particles.hpp"

namespace mpm::scene {

/// One particle that is followed through the run, wherever it goes.
class WatchedParticle {
 public:
  /// The particle nearest to x. Throws BadInput if its law has no void_ratio or no eps_q.
  /// Collective.
  WatchedParticle(const particles::Particles<2>& particles, const Vector<2>& x);

  /// q, p, volumetric strain, void ratio, eps_q; compression positive. Collective.
  std::vector<double> observe(const particles::Particles<2>& particles) const;

 private:
  struct Found {
    std::int64_t id;
    double volume;  ///< m^3
    int material;
  };
  static Found nearest(const particles::Particles<2>& particles, const Vector<2>& x);
  WatchedParticle(const Found& found, const particles::Particles<2>& particles);

  std::int64_t m_id;
  double m_initial_volume;
  particles::StateHandle m_void_ratio, m_eps_q;
};

}  // namespace mpm::scene
