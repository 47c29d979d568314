#include "mpm/contact/RigidMass.hpp"

#include <cmath>
#include <utility>

#include "ScalarAndGradient.hpp"

namespace mpm::contact {

template <int dim>
RigidMass<dim>::RigidMass(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
                          const transfer::PointDeposit<dim>& deposit, const RigidBody<dim>& body)
    : m_grid(grid),
      m_walls(walls),
      m_deposit(deposit),
      m_body(body),
      m_field(grid, scalar_and_gradient<dim>()) {}

template <int dim>
void RigidMass<dim>::fill(std::vector<Vector<dim>> points, double volume_of_each) {
  m_points = std::move(points);
  m_point_volume = volume_of_each;
}

template <int dim>
void RigidMass<dim>::provide() {
  if (m_is_fresh) return;
  m_is_fresh = true;
  std::vector<Vector<dim>> points = m_points;
  for (Vector<dim>& x : points)
    for (int d = 0; d < dim; ++d) x[d] += m_body.position[d];
  m_field.set_to_zero();
  m_deposit.deposit(points, m_point_volume, m_grid.owned_cells(), m_field);
  m_field.sum_to_owners();
  m_walls.fold(m_grid, m_field);
}

template <int dim>
std::optional<Vector<dim>> RigidMass<dim>::normal(int local) const {
  Vector<dim> outward;
  double square = 0.0;
  for (int d = 0; d < dim; ++d) {
    outward[d] = m_field.values(1 + d)[local];
    square += outward[d] * outward[d];
  }
  const double length = std::sqrt(square);
  if (length == 0.0) return std::nullopt;
  for (double& component : outward) component /= length;
  return outward;
}

template class RigidMass<1>;
template class RigidMass<2>;
template class RigidMass<3>;

}  // namespace mpm::contact
