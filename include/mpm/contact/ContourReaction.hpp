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
/// with w the body's velocity there; the band in which chi falls is the contour, made as wide as a
/// few cells so that particle stresses are averaged. The moment is that of the same terms about the
/// reference point, which moves with w_0 and so adds - sum m chi w_0 x v.
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

  /// Mean reaction since the last call over the ranks that have the particles. Collective.
  BodyForce<dim> take_mean(const petsc::Communicator& communicator = petsc::world());

  void persist(Archive& archive) {
    archive.sum("force_time", m_force_time.force);
    archive.sum("moment_time", m_force_time.moment);
    archive.sum("momentum", m_momentum.force);
    archive.sum("angular_momentum", m_momentum.moment);
    archive("first_momentum", m_first_momentum.force);
    archive("first_angular_momentum", m_first_momentum.moment);
    archive("time", m_time);
    archive("has_start", m_has_start);
  }

 private:
  double share_of_band(double distance) const {
    return (distance - m_band.inner) / (m_band.outer - m_band.inner);
  }

  /// Adds a force at r to `sum`.
  static void add(BodyForce<dim>& sum, const Vector<dim>& r, const Vector<dim>& force) {
    for (int d = 0; d < dim; ++d) sum.force[d] += force[d];
    if constexpr (dim == 2) sum.moment += moment_of<dim>(r, force);
  }
  double mean_of(double force_time, double momentum, double& first_momentum,
                 const petsc::Communicator& communicator) const;

  ContourBand m_band;
  BodyForce<dim> m_force_time;      ///< integrals of the terms over time
  BodyForce<dim> m_momentum;        ///< sum m v chi of the last sample, and r x that
  BodyForce<dim> m_first_momentum;  ///< the same at the start of the interval, over all ranks
  double m_time = 0.0;
  bool m_has_start = false;
};

extern template class ContourReaction<1>;
extern template class ContourReaction<2>;
extern template class ContourReaction<3>;

}  // namespace mpm::contact
