#pragma once

#include <memory>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/contact/SpringContact.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::cases {

/// The half space below a height, m.
inline std::shared_ptr<contact::RigidBody<2>> ground(double height) {
  return std::make_shared<contact::RigidBody<2>>(
      std::make_shared<geometry::HalfSpace<2>>(Vector<2>{0.0, 1.0}), Vector<2>{0.0, height});
}

/// Points that fill a rigid body, for contact found through its nodal mass.
template <int dim>
struct RigidPoints {
  std::vector<Vector<dim>> from_reference;
  double volume_of_each = 0.0;
};

/// Contact of all particles of a simulation, which must outlive it, with a rigid body. Collective.
template <int dim>
std::shared_ptr<grid::Constraint<dim>> contact_of(
    const solver::Simulation<dim>& simulation, const std::shared_ptr<contact::RigidBody<dim>>& body,
    const contact::ContactOptions& options, RigidPoints<dim> points = {}) {
  if (contact::detection_kinds()[options.detection].is_by_springs())
    return std::make_shared<contact::SpringContact<dim>>(simulation.grid(), simulation.walls(),
                                                         simulation.step().point_deposit(),
                                                         simulation.particles(), body, options);
  auto contact = std::make_shared<contact::RigidContact<dim>>(
      simulation.grid(), simulation.walls(), simulation.step().point_deposit(), body, options);
  contact->watch(simulation.particles());
  contact->discretise(std::move(points.from_reference), points.volume_of_each);
  return contact;
}

}  // namespace mpm::cases
