#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mpm/run/Observer.hpp"

namespace mpm::run {

/// What is seen of a followed particle; compression positive.
template <int dim>
struct Watched {
  Vector<dim> position, displacement;  ///< m
  double q, p;                         ///< Pa
  double volumetric_strain, deviatoric_strain;
  std::vector<double> states;  ///< of its law, those that were asked for
};

/// One particle that is followed through the run, wherever it goes: the one that is nearest to a
/// point when the run begins.
template <int dim>
class WatchedParticle : public Observer<dim> {
 public:
  /// `states` are names of state variables of its law.
  explicit WatchedParticle(const Vector<dim>& near, std::vector<std::string> states = {})
      : m_near(near), m_states(std::move(states)) {}

  /// Finds the particle. Throws BadInput if its law has no such state.
  void begin(const Moment<dim>& moment) override;
  void persist(Archive& archive) override;

  /// Collective.
  Watched<dim> observe(const particles::Particles<dim>& particles) const;

 private:
  void find(const particles::Particles<dim>& particles);
  std::vector<double> look_at(const particles::Particles<dim>& particles,
                              const particles::ParticleView<dim>& view, int p) const;

  Vector<dim> m_near;
  std::vector<std::string> m_states;
  std::int64_t m_id = -1;
  double m_initial_volume = 0.0;  ///< m^3
  int m_material = 0;
};

extern template class WatchedParticle<1>;
extern template class WatchedParticle<2>;
extern template class WatchedParticle<3>;

}  // namespace mpm::run
