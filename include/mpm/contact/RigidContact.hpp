#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mpm/contact/ContactOptions.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/grid/Constraint.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/transfer/PointDeposit.hpp"

namespace mpm::contact {

/// Frictional contact with a rigid body on grid nodes (Bardenhagen et al. 2000; Zhang, Chen & Liu
/// 2017): where the bodies touch and close in on each other, a friction law says how the velocity
/// changes. Only the deformable body is corrected. Books on the body's meter.
template <int dim>
class RigidContact : public grid::Constraint<dim> {
 public:
  RigidContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
               const transfer::PointDeposit<dim>& deposit, std::shared_ptr<RigidBody<dim>> body,
               const ContactOptions& options);

  RigidContact(const RigidContact&) = delete;
  RigidContact& operator=(const RigidContact&) = delete;

  /// Fills the rigid body with points, needed where contact is found through its nodal mass.
  void discretise(std::vector<Vector<dim>> points_from_reference, double volume_of_each) {
    m_rigid_mass.fill(std::move(points_from_reference), volume_of_each);
  }

  /// The deformable body, needed where contact is found through its particles; must outlive this.
  void watch(const particles::Particles<dim>& particles) { m_particles = &particles; }

  RigidBody<dim>& body() { return *m_body; }
  const RigidBody<dim>& body() const { return *m_body; }

  void look_at_particles(double) override { m_detection->look_at_particles(); }
  void find_nodes() override;
  void constrain(const grid::Grid<dim>& grid, grid::ConstrainedNodes<dim>& nodes) override;
  bool spares_from_damping() const override { return true; }
  std::string label() const override { return m_options.label; }
  grid::Booking<dim>& booking() override { return m_body->meter().booking(); }

 private:
  /// A node where the bodies touch if they close in on each other.
  struct TouchingNode {
    int local;
    double smallest_mass;  ///< of the deformable body, to take part, kg
    Vector<dim> normal;
    Vector<dim> lever;  ///< from the body's reference point, m
  };
  void add(const NearNode<dim>& near);
  void constrain(const TouchingNode& node, grid::ConstrainedNodes<dim>& nodes);

  const grid::Grid<dim>& m_grid;
  std::shared_ptr<RigidBody<dim>> m_body;
  ContactOptions m_options;
  std::unique_ptr<FrictionLaw<dim>> m_friction;
  RigidMass<dim> m_rigid_mass;
  const particles::Particles<dim>* m_particles = nullptr;
  std::unique_ptr<Detection<dim>> m_detection;
  std::vector<NearNode<dim>> m_near_nodes;     ///< of the present step
  std::vector<TouchingNode> m_touching_nodes;  ///< of the present step
};

extern template class RigidContact<1>;
extern template class RigidContact<2>;
extern template class RigidContact<3>;

}  // namespace mpm::contact
