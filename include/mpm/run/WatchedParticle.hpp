#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mpm/run/Observer.hpp"

namespace mpm::run {

/// One particle that is followed through the run, wherever it goes: the one that is nearest to a
/// point when the run begins.
template <int dim>
class WatchedParticle : public Observer<dim> {
 public:
  explicit WatchedParticle(const Vector<dim>& near) : m_near(near) {}

  /// Finds the particle. Throws BadInput if its law has no void_ratio or no eps_q.
  void begin(const Moment<dim>& moment) override;
  void persist(Archive& archive) override;

  /// q, p, volumetric strain, void ratio, eps_q; compression positive. Collective.
  std::vector<double> observe(const particles::Particles<dim>& particles) const;

 private:
  void find(const particles::Particles<dim>& particles);

  Vector<dim> m_near;
  std::int64_t m_id = -1;
  double m_initial_volume = 0.0;  ///< m^3
  int m_material = 0;
};

extern template class WatchedParticle<2>;
extern template class WatchedParticle<3>;

}  // namespace mpm::run
