#include "mpm/contact/RigidContact.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace mpm::contact {
namespace {

constexpr double smallest_mass_share = 1e-9;  // of a full cell
constexpr double round_off = 1e-12;           // of a particle's vote

template <int dim>
std::vector<grid::Component> scalar_and_gradient() {
  std::vector<grid::Component> components{{grid::Component::scalar}};
  for (int d = 0; d < dim; ++d) components.push_back({d});
  return components;
}

template <int dim>
double dot(const Vector<dim>& a, const Vector<dim>& b) {
  double sum = 0.0;
  for (int d = 0; d < dim; ++d) sum += a[d] * b[d];
  return sum;
}

/// Change of the deformable body's velocity where it closes in on the rigid one with `relative`.
template <int dim>
Vector<dim> velocity_change(const Vector<dim>& relative, const Vector<dim>& normal,
                            double friction) {
  const double closing = -dot<dim>(relative, normal);
  Vector<dim> sliding, change;
  for (int d = 0; d < dim; ++d) sliding[d] = relative[d] + closing * normal[d];
  const double speed = std::sqrt(dot<dim>(sliding, sliding));
  const double share = speed > friction * closing ? friction * closing / speed : 1.0;
  for (int d = 0; d < dim; ++d) change[d] = closing * normal[d] - share * sliding[d];
  return change;
}

template <int dim>
double cell_volume(const grid::Grid<dim>& grid, const std::array<int, dim>& node) {
  double volume = 1.0;
  for (int d = 0; d < dim; ++d)
    volume *= grid.nodes(d).cell_width[static_cast<std::size_t>(node[d])];
  return volume;
}

}  // namespace

template <int dim>
RigidContact<dim>::RigidContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
                                const transfer::PointDeposit<dim>& deposit, RigidBody<dim> body,
                                const ContactOptions& options)
    : m_grid(grid),
      m_walls(walls),
      m_deposit(deposit),
      m_body(std::move(body)),
      m_options(options),
      m_rigid_mass(grid, scalar_and_gradient<dim>()),
      m_active(static_cast<std::size_t>(grid.local_size()), false) {}

template <int dim>
void RigidContact<dim>::discretise(std::vector<Vector<dim>> points, double volume_of_each) {
  m_points = std::move(points);
  m_point_volume = volume_of_each;
}

template <int dim>
void RigidContact<dim>::begin_step() {
  std::fill(m_active.begin(), m_active.end(), false);
  if (m_options.detection == Detection::velocity || m_options.normal == Normal::gradient)
    deposit_rigid_mass();
  if (m_options.detection == Detection::particle) deposit_votes();
}

template <int dim>
void RigidContact<dim>::deposit_rigid_mass() {
  std::vector<Vector<dim>> points = m_points;
  for (Vector<dim>& x : points)
    for (int d = 0; d < dim; ++d) x[d] += m_body.position[d];
  m_rigid_mass.set_to_zero();
  m_deposit.deposit(points, m_point_volume, m_grid.owned_cells(), m_rigid_mass);
  m_rigid_mass.sum_to_owners();
  m_walls.fold(m_grid, m_rigid_mass);
}

/// Particles whose own extent meets the surface touch it; those that miss it by up to half their
/// extent lie beside it all the same.
template <int dim>
void RigidContact<dim>::prepare_step() {
  if (m_options.detection != Detection::particle) return;
  if (!m_particles) throw std::logic_error("contact by particles without watch()");
  m_touching.clear();
  m_missing.clear();
  const auto view = m_particles->view();
  for (int p = 0; p < view.count; ++p) {
    const Vector<dim> x = view.position_of(p);
    const double extents = m_body.locate(x).distance / std::pow(view.volume[p], 1.0 / dim);
    if (extents <= 1.0) (extents <= 0.5 ? m_touching : m_missing).push_back(x);
  }
}

/// Each votes with its weight on the nodes that it reaches, for or against.
template <int dim>
void RigidContact<dim>::deposit_votes() {
  if (!m_votes)
    m_votes = std::make_unique<grid::NodalField<dim>>(m_grid, scalar_and_gradient<dim>());
  m_votes->set_to_zero();
  m_deposit.deposit(m_touching, 1.0, m_grid.reachable_cells(), *m_votes);
  m_deposit.deposit(m_missing, -1.0, m_grid.reachable_cells(), *m_votes);
  m_votes->sum_to_owners();
  m_walls.fold(m_grid, *m_votes);
}

template <int dim>
bool RigidContact<dim>::is_near(const grid::Grid<dim>& grid, const std::array<int, dim>& node,
                                double distance) const {
  double cell = 0.0;
  for (int d = 0; d < dim; ++d)
    cell = std::max(cell, grid.nodes(d).cell_width[static_cast<std::size_t>(node[d])]);
  return distance <= m_options.gap_cells * cell;
}

template <int dim>
std::optional<Vector<dim>> RigidContact<dim>::touching(const grid::Grid<dim>& grid, int local,
                                                       const std::array<int, dim>& node) const {
  const Proximity<dim> proximity = m_body.locate(grid.position(node));
  if (m_options.detection != Detection::velocity) {
    if (!is_near(grid, node, proximity.distance)) return std::nullopt;
    if (m_votes && m_votes->values(0)[local] <= round_off) return std::nullopt;
  } else if (m_rigid_mass.values(0)[local] < smallest_mass_share * cell_volume<dim>(grid, node)) {
    return std::nullopt;
  }
  if (m_options.normal == Normal::surface) return proximity.normal;
  Vector<dim> outward;
  for (int d = 0; d < dim; ++d) outward[d] = m_rigid_mass.values(1 + d)[local];
  const double length = std::sqrt(dot<dim>(outward, outward));
  if (length == 0.0) return std::nullopt;
  for (double& component : outward) component /= length;
  return outward;
}

template <int dim>
void RigidContact<dim>::correct(const grid::Grid<dim>& grid, const grid::NodalMotion<dim>& motion) {
  grid.for_each_active_node([&](int local, const std::array<int, dim>& node) {
    const double m_I = motion.mass[local];
    if (m_I == 0.0) return;
    if (m_I < smallest_mass_share * m_options.reference_density * cell_volume<dim>(grid, node))
      return;
    const auto normal = touching(grid, local, node);
    if (!normal) return;
    Vector<dim> relative;
    for (int d = 0; d < dim; ++d)
      relative[d] = motion.momentum[d][local] / m_I - m_body.velocity[d];
    if (dot<dim>(relative, *normal) >= 0.0) return;
    const Vector<dim> change = velocity_change<dim>(relative, *normal, m_options.friction);
    for (int d = 0; d < dim; ++d) motion.momentum[d][local] += m_I * change[d];
    if (!motion.is_first_mapping()) return;
    m_active[static_cast<std::size_t>(local)] = true;
    for (int d = 0; d < dim; ++d) {
      motion.force[d][local] += m_I * change[d] / motion.dt;
      m_impulse[d] -= m_I * change[d];
    }
  });
}

template <int dim>
Vector<dim> RigidContact<dim>::take_impulse() {
  return std::exchange(m_impulse, Vector<dim>{});
}

template class RigidContact<1>;
template class RigidContact<2>;
template class RigidContact<3>;

}  // namespace mpm::contact
