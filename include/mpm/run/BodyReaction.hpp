#pragma once

#include <memory>

#include "mpm/contact/ContourReaction.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/run/Observer.hpp"

namespace mpm::run {

/// Measures what the ground does to a rigid body in two ways that share nothing: the impulses that
/// the contact has booked, and the momentum balance of the soil within a contour around the body.
template <int dim>
class BodyReaction : public Observer<dim> {
 public:
  BodyReaction(std::shared_ptr<contact::RigidBody<dim>> body, const contact::ContourBand& band)
      : m_body(std::move(body)), m_contour(band) {}

  /// What was booked before the stage does not count.
  void begin_stage(const Moment<dim>&) override { m_body->meter().forget(); }

  void after_step(const Moment<dim>& now) override {
    const double dt = now.clock.momentum_dt;
    m_contour.sample(now.simulation.particles().view(), *m_body, now.simulation.gravity(), dt);
    if (!now.simulation.boundary().is_empty())
      m_contour.sample_surface(now.simulation.boundary().view(), *m_body, dt);
  }

  void persist(Archive& archive) override {
    archive.group("contour", [&] { m_contour.persist(archive); });
  }

  /// Means since the last call. Collective.
  contact::BodyForce<dim> take_by_impulse(const petsc::Communicator& ranks = petsc::world()) {
    return m_body->meter().take_mean(ranks);
  }
  contact::BodyForce<dim> take_by_contour(const petsc::Communicator& ranks = petsc::world()) {
    return m_contour.take_mean(ranks);
  }

 private:
  std::shared_ptr<contact::RigidBody<dim>> m_body;
  contact::ContourReaction<dim> m_contour;
};

}  // namespace mpm::run
