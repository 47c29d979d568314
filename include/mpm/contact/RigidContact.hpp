#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mpm/contact/Friction.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/grid/Constraint.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/transfer/PointDeposit.hpp"

namespace mpm::contact {

/// When two bodies count as touching.
enum class Detection {
  velocity,  ///< as soon as they share a node and approach each other (the paper)
  gap,       ///< when the node is nearer to the surface than a share of a cell
  particle   ///< when, besides, most particles beside the surface at this node touch it
};

/// Where the contact normal comes from.
enum class Normal {
  surface,  ///< the rigid surface itself
  gradient  ///< the gradient of the rigid body's nodal mass (the paper)
};

struct ContactOptions {
  Detection detection = Detection::gap;
  Normal normal = Normal::surface;
  double gap_cells = 0.6;          ///< largest distance of a touching node, in cells
  double friction = 0.0;           ///< Coulomb coefficient mu
  std::size_t friction_law = 0;    ///< row of friction_kinds()
  double reference_density = 1.0;  ///< of the deformable body, kg/m^3: nodes with less than 1e-9
                                   ///< of a full cell's mass take no part
  std::string label = "contact";   ///< in the ledger
};

/// Frictional contact with a rigid body on grid nodes (Bardenhagen et al. 2000; Zhang, Chen & Liu
/// 2017): where the bodies touch and close in on each other, a friction law says how the velocity
/// changes. Only the deformable body is corrected. Books on the body's meter.
template <int dim>
class RigidContact : public grid::Constraint<dim> {
 public:
  RigidContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
               const transfer::PointDeposit<dim>& deposit, std::shared_ptr<RigidBody<dim>> body,
               const ContactOptions& options);

  /// Fills the rigid body with points, needed where contact is found through its nodal mass.
  void discretise(std::vector<Vector<dim>> points_from_reference, double volume_of_each);

  /// The deformable body, needed where contact is found through its particles; must outlive this.
  void watch(const particles::Particles<dim>& particles) { m_particles = &particles; }

  RigidBody<dim>& body() { return *m_body; }
  const RigidBody<dim>& body() const { return *m_body; }

  void look_at_particles() override;
  void find_nodes() override;
  void constrain(const grid::Grid<dim>& grid, grid::ConstrainedNodes<dim>& nodes) override;
  bool spares_from_damping() const override { return true; }
  std::string label() const override { return m_options.label; }
  grid::Booking<dim>& booking() override { return m_body->meter().booking(); }

 private:
  void deposit_rigid_mass();
  void deposit_votes();
  bool is_near(const std::array<int, dim>& node, double distance) const;
  void find_touching_nodes();
  void find_near_nodes(const grid::Run<dim>& run);
  void find_nodes_with_rigid_mass(const grid::Run<dim>& run);
  /// Takes the node as one where the bodies touch, unless it has no normal.
  void add_touching(int local, const std::array<int, dim>& node, const Vector<dim>& surface_normal);
  std::optional<Vector<dim>> normal_at(int local, const Vector<dim>& surface_normal) const;

  /// A node where the bodies touch if they close in on each other.
  struct TouchingNode {
    int local;
    double smallest_mass;  ///< of the deformable body, to take part, kg
    Vector<dim> normal;
    Vector<dim> lever;  ///< from the body's reference point, m
  };
  void constrain(const TouchingNode& node, grid::ConstrainedNodes<dim>& nodes);

  const grid::Grid<dim>& m_grid;
  const grid::Walls<dim>& m_walls;
  const transfer::PointDeposit<dim>& m_deposit;
  std::shared_ptr<RigidBody<dim>> m_body;
  ContactOptions m_options;
  std::unique_ptr<FrictionLaw<dim>> m_friction;
  std::vector<Vector<dim>> m_points;
  double m_point_volume = 0.0;
  grid::NodalField<dim> m_rigid_mass;  ///< nodal volume of the rigid body and its gradient
  const particles::Particles<dim>* m_particles = nullptr;
  std::vector<Vector<dim>> m_touching, m_missing;  ///< particles beside the surface
  std::unique_ptr<grid::NodalField<dim>> m_votes;  ///< positive where most particles touch
  double m_reach;                                  ///< largest distance of a near node, m
  std::vector<TouchingNode> m_touching_nodes;      ///< of the present step
};

extern template class RigidContact<1>;
extern template class RigidContact<2>;
extern template class RigidContact<3>;

}  // namespace mpm::contact
