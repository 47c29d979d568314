#pragma once

#include <optional>
#include <vector>

#include "mpm/contact/RigidBody.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/transfer/PointDeposit.hpp"

namespace mpm::contact {

/// A rigid body on the nodes of the grid: its volume, as points that fill it deposit it, and the
/// gradient of that (the paper's nodal mass of a rigid body).
template <int dim>
class RigidMass {
 public:
  RigidMass(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
            const transfer::PointDeposit<dim>& deposit, const RigidBody<dim>& body);

  void fill(std::vector<Vector<dim>> points_from_reference, double volume_of_each);
  /// A step begins: what was deposited in the one before is stale.
  void forget() { m_is_fresh = false; }
  /// Deposits where the body is now, once a step whoever asks first. Collective.
  void provide();

  /// m^3 per unit of the dimensions left out.
  double volume(int local) const { return m_field.values(0)[local]; }
  /// Out of the body, unit; none where the gradient vanishes.
  std::optional<Vector<dim>> normal(int local) const;

 private:
  const grid::Grid<dim>& m_grid;
  const grid::Walls<dim>& m_walls;
  const transfer::PointDeposit<dim>& m_deposit;
  const RigidBody<dim>& m_body;
  std::vector<Vector<dim>> m_points;
  double m_point_volume = 0.0;
  bool m_is_fresh = false;
  grid::NodalField<dim> m_field;
};

extern template class RigidMass<1>;
extern template class RigidMass<2>;
extern template class RigidMass<3>;

}  // namespace mpm::contact
