#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "mpm/contact/ContactOptions.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/grid/Constraint.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/transfer/PointDeposit.hpp"

namespace mpm::contact {

/// Frictional contact of particles with a rigid surface, which knows nothing of the grid. A
/// particle touches where its centre is nearer than its extent along the normal, and is then held
/// by a spring with a dashpot and by a sliding spring, whose force it hands to the nodes as it does
/// its weight (compare Nakamura, Matsumura & Mizutani 2021, Comput. Geotech. 134:104069). With o
/// the overlap, u the motion along the surface and n the normal,
///   f_n += k do >= 0,  f_t -= k du, limited by the friction law,  f = f_n n + f_t + c (do/dt) n
/// with k = m_p/dt^2, as stiff as the step allows: under a pressure p it gives way by about p/E of
/// a cell, E the soil's stiffness. Extents deform with the particles, since what lies between a
/// centre and the surface is soil as well. Particles that stand beside the surface at the start
/// under stress reach up to it and carry their traction; what overlaps then does not push.
template <int dim>
class SpringContact : public grid::Constraint<dim> {
 public:
  /// `particles` must have the columns of a contact of this label (particles::OptionalColumns) and,
  /// as the rest, outlive this. Collective.
  SpringContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
                const transfer::PointDeposit<dim>& deposit,
                const particles::Particles<dim>& particles, std::shared_ptr<RigidBody<dim>> body,
                const ContactOptions& options);

  void look_at_particles(double dt) override;
  void find_nodes() override;
  void constrain(const grid::Grid<dim>& grid, grid::ConstrainedNodes<dim>& nodes) override;
  std::string label() const override { return m_options.label; }
  grid::Booking<dim>& booking() override { return m_body->meter().booking(); }
  void persist(Archive& archive) override;

  RigidBody<dim>& body() { return *m_body; }

 private:
  using View = particles::ParticleView<dim>;
  struct Touch;
  void renew_watched(const View& view, double dt);
  void look_at(const View& view, int p, double dt);
  void begin(const View& view, int p, const geometry::Proximity<dim>& surface) const;
  Vector<dim> held_by_springs(const Touch& touch) const;

  const grid::Grid<dim>& m_grid;
  const grid::Walls<dim>& m_walls;
  const transfer::PointDeposit<dim>& m_deposit;
  const particles::Particles<dim>& m_particles;
  std::shared_ptr<RigidBody<dim>> m_body;
  ContactOptions m_options;
  std::unique_ptr<FrictionLaw<dim>> m_friction;
  particles::StateHandle m_force, m_place, m_overlap, m_reach;  ///< columns of the particles
  std::vector<int> m_watched;                                   ///< particles that may be near
  long long m_watched_order = -1;               ///< of the particles when they were found
  double m_way_left = 0.0;                      ///< m, before others may be near
  std::vector<Vector<dim>> m_points, m_forces;  ///< of touching particles in this step
  grid::NodalField<dim> m_nodal_force;
};

extern template class SpringContact<1>;
extern template class SpringContact<2>;
extern template class SpringContact<3>;

}  // namespace mpm::contact
