#pragma once

#include <memory>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::cases {

/// The half space below a height, m.
inline std::shared_ptr<contact::RigidBody<2>> ground(double height) {
  return std::make_shared<contact::RigidBody<2>>(
      std::make_shared<geometry::HalfSpace<2>>(Vector<2>{0.0, 1.0}), Vector<2>{0.0, height});
}

/// Contact of all particles of a simulation, which must outlive it, with a rigid body. Collective.
template <int dim>
std::shared_ptr<contact::RigidContact<dim>> contact_of(
    const solver::Simulation<dim>& simulation, const std::shared_ptr<contact::RigidBody<dim>>& body,
    const contact::ContactOptions& options) {
  auto contact = std::make_shared<contact::RigidContact<dim>>(
      simulation.grid(), simulation.walls(), simulation.step().point_deposit(), body, options);
  contact->watch(simulation.particles());
  return contact;
}

}  // namespace mpm::cases
