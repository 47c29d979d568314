#pragma once

#include "mpm/contact/RigidBody.hpp"
#include "mpm/particles/BoundaryParticles.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::contact {

/// Width of the cut-off around a rigid body, distances from its surface in metres.
struct ContourBand {
  double inner;  ///< chi = 1 up to here
  double outer;  ///< chi = 0 from here, a smooth step between
};

/// The reaction on a rigid body without asking the contact: the momentum balance of the soil
/// inside a cut-off chi that moves with the body. Integrated against chi, it reads
///   R = -d/dt sum m v chi + sum m v ((v - w).grad chi) - sum V sigma.grad chi + sum m g chi
///       - sum p a chi
/// with w the body's velocity; the band in which chi falls is the contour, made as wide as a few
/// cells so that particle stresses are averaged.
template <int dim>
class ContourReaction {
 public:
  explicit ContourReaction(const ContourBand& band) : m_band(band) {}

  /// Adds the present state with the weight `dt`, this rank's share. Local.
  void sample(const particles::ParticleView<dim>& particles, const RigidBody<dim>& body,
              const Vector<dim>& gravity, double dt);

  /// Adds the pressure on the body's own surface with the weight `dt`. Local.
  void sample_surface(const particles::BoundaryView<dim>& boundary, const RigidBody<dim>& body,
                      double dt);

  /// Mean reaction since the last call, N (per metre in plane strain), over the ranks that have the
  /// particles. Collective.
  Vector<dim> take_mean(const petsc::Communicator& communicator = petsc::world());

  void persist(Archive& archive) {
    archive("force_time", m_force_time);
    archive("momentum", m_momentum);
    archive("first_momentum", m_first_momentum);
    archive("time", m_time);
    archive("has_start", m_has_start);
  }

 private:
  double share_of_band(double distance) const {
    return (distance - m_band.inner) / (m_band.outer - m_band.inner);
  }

  ContourBand m_band;
  Vector<dim> m_force_time{};      ///< integral of the force terms over time
  Vector<dim> m_momentum{};        ///< sum m v chi of the last sample
  Vector<dim> m_first_momentum{};  ///< the same at the start of the interval, over all ranks
  double m_time = 0.0;
  bool m_has_start = false;
};

extern template class ContourReaction<2>;
extern template class ContourReaction<3>;

}  // namespace mpm::contact
