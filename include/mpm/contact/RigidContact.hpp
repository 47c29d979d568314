#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mpm/contact/Surface.hpp"
#include "mpm/grid/NodalCondition.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/transfer/PointDeposit.hpp"

namespace mpm::contact {

/// A body without stress whose velocity is prescribed.
template <int dim>
struct RigidBody {
  std::shared_ptr<const Surface<dim>> surface;
  Vector<dim> position{};  ///< of the reference point, m
  Vector<dim> velocity{};  ///< m/s

  Proximity<dim> locate(const Vector<dim>& x) const {
    Vector<dim> r;
    for (int d = 0; d < dim; ++d) r[d] = x[d] - position[d];
    return surface->locate(r);
  }
};

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
  double reference_density = 1.0;  ///< of the deformable body, kg/m^3: nodes with less than 1e-9
                                   ///< of a full cell's mass take no part
};

/// Frictional contact with a rigid body on grid nodes (Bardenhagen et al. 2000; Zhang, Chen & Liu
/// 2017): where the bodies touch, the closing part of the relative velocity is removed and the
/// sliding part reduced by at most mu times it. Only the deformable body is corrected.
template <int dim>
class RigidContact : public grid::NodalCondition<dim> {
 public:
  RigidContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
               const transfer::PointDeposit<dim>& deposit, RigidBody<dim> body,
               const ContactOptions& options);

  /// Fills the rigid body with points, needed where contact is found through its nodal mass.
  void discretise(std::vector<Vector<dim>> points_from_reference, double volume_of_each);

  /// The deformable body, needed where contact is found through its particles; must outlive this.
  void watch(const particles::Particles<dim>& particles) { m_particles = &particles; }

  RigidBody<dim>& body() { return m_body; }
  const RigidBody<dim>& body() const { return m_body; }

  void prepare_step() override;
  void begin_step() override;
  void correct(const grid::Grid<dim>& grid, const grid::NodalMotion<dim>& motion) override;
  std::span<const int> acted_nodes() const override { return m_acted; }

  /// Impulse of the deformable body on the rigid one since the last call, N s (per metre in plane
  /// strain), this rank's share.
  Vector<dim> take_impulse();

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
  void correct(int local, const Vector<dim>& normal, const grid::NodalMotion<dim>& motion);

  /// A node where the bodies touch if they close in on each other.
  struct TouchingNode {
    int local;
    double smallest_mass;  ///< of the deformable body, to take part, kg
    Vector<dim> normal;
  };

  const grid::Grid<dim>& m_grid;
  const grid::Walls<dim>& m_walls;
  const transfer::PointDeposit<dim>& m_deposit;
  RigidBody<dim> m_body;
  ContactOptions m_options;
  std::vector<Vector<dim>> m_points;
  double m_point_volume = 0.0;
  grid::NodalField<dim> m_rigid_mass;  ///< nodal volume of the rigid body and its gradient
  const particles::Particles<dim>* m_particles = nullptr;
  std::vector<Vector<dim>> m_touching, m_missing;  ///< particles beside the surface
  std::unique_ptr<grid::NodalField<dim>> m_votes;  ///< positive where most particles touch
  double m_reach;                                  ///< largest distance of a near node, m
  std::vector<TouchingNode> m_touching_nodes;      ///< of the present step
  std::vector<int> m_acted;
  Vector<dim> m_impulse{};
};

extern template class RigidContact<1>;
extern template class RigidContact<2>;
extern template class RigidContact<3>;

}  // namespace mpm::contact
