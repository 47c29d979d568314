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

template <int dim>
double cell_volume(const grid::Grid<dim>& grid, const std::array<int, dim>& node) {
  double volume = 1.0;
  for (int d = 0; d < dim; ++d)
    volume *= grid.nodes(d).cell_width[static_cast<std::size_t>(node[d])];
  return volume;
}

template <int dim>
double largest_cell_width(const grid::Grid<dim>& grid) {
  double largest = 0.0;
  for (int d = 0; d < dim; ++d)
    largest = std::max(largest, std::ranges::max(grid.nodes(d).cell_width));
  return largest;
}

}  // namespace

template <int dim>
RigidContact<dim>::RigidContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
                                const transfer::PointDeposit<dim>& deposit,
                                std::shared_ptr<RigidBody<dim>> body, const ContactOptions& options)
    : m_grid(grid),
      m_walls(walls),
      m_deposit(deposit),
      m_body(std::move(body)),
      m_options(options),
      m_friction(make_friction<dim>(options.friction_law, {.coefficient = options.friction})),
      m_rigid_mass(grid, scalar_and_gradient<dim>()),
      m_reach(options.gap_cells * largest_cell_width(grid)) {}

template <int dim>
void RigidContact<dim>::discretise(std::vector<Vector<dim>> points, double volume_of_each) {
  m_points = std::move(points);
  m_point_volume = volume_of_each;
}

template <int dim>
void RigidContact<dim>::find_nodes() {
  if (m_options.detection == Detection::velocity || m_options.normal == Normal::gradient)
    deposit_rigid_mass();
  if (m_options.detection == Detection::particle) deposit_votes();
  find_touching_nodes();
}

template <int dim>
void RigidContact<dim>::deposit_rigid_mass() {
  std::vector<Vector<dim>> points = m_points;
  for (Vector<dim>& x : points)
    for (int d = 0; d < dim; ++d) x[d] += m_body->position[d];
  m_rigid_mass.set_to_zero();
  m_deposit.deposit(points, m_point_volume, m_grid.owned_cells(), m_rigid_mass);
  m_rigid_mass.sum_to_owners();
  m_walls.fold(m_grid, m_rigid_mass);
}

/// Particles whose own extent meets the surface touch it; those that miss it by up to half their
/// extent lie beside it all the same.
template <int dim>
void RigidContact<dim>::look_at_particles() {
  if (m_options.detection != Detection::particle) return;
  if (!m_particles) throw std::logic_error("contact by particles without watch()");
  m_touching.clear();
  m_missing.clear();
  const auto view = m_particles->view();
  for (int p = 0; p < view.count; ++p) {
    const Vector<dim> x = view.position_of(p);
    const double extents = m_body->locate(x).distance / std::pow(view.volume[p], 1.0 / dim);
    if (extents <= 1.0) (extents <= 0.5 ? m_touching : m_missing).push_back(x);
  }
}

/// Each votes with its weight on the nodes that it reaches, for or against.
template <int dim>
void RigidContact<dim>::deposit_votes() {
  if (!m_votes)
    m_votes = std::make_unique<grid::NodalField<dim>>(m_grid, scalar_and_gradient<dim>());
  m_votes->set_active_to_zero();
  m_deposit.deposit(m_touching, 1.0, m_grid.reachable_cells(), *m_votes);
  m_deposit.deposit(m_missing, -1.0, m_grid.reachable_cells(), *m_votes);
  m_votes->sum_to_owners();
  m_walls.fold(m_grid, *m_votes);
}

template <int dim>
bool RigidContact<dim>::is_near(const std::array<int, dim>& node, double distance) const {
  double cell = 0.0;
  for (int d = 0; d < dim; ++d)
    cell = std::max(cell, m_grid.nodes(d).cell_width[static_cast<std::size_t>(node[d])]);
  return distance <= m_options.gap_cells * cell;
}

/// Where the bodies touch does not depend on their motion: once for both mappings of a step.
template <int dim>
void RigidContact<dim>::find_touching_nodes() {
  m_touching_nodes.clear();
  for (const grid::Run<dim>& run : m_grid.active_runs())
    if (m_options.detection == Detection::velocity)
      find_nodes_with_rigid_mass(run);
    else
      find_near_nodes(run);
}

/// Passes over nodes that are too close to a far one to be near.
template <int dim>
void RigidContact<dim>::find_near_nodes(const grid::Run<dim>& run) {
  const double* const x = m_grid.nodes(0).positions.data() + run.node[0];
  for (int k = 0; k < run.count;) {
    std::array<int, dim> node = run.node;
    node[0] += k;
    const geometry::Proximity<dim> proximity = m_body->locate(m_grid.position(node));
    if (is_near(node, proximity.distance)) add_touching(run.first + k, node, proximity.normal);
    const double next = x[k++] + (1.0 - round_off) * (proximity.distance - m_reach);
    while (k < run.count && x[k] < next) ++k;
  }
}

template <int dim>
void RigidContact<dim>::find_nodes_with_rigid_mass(const grid::Run<dim>& run) {
  const double* const rigid_mass = m_rigid_mass.values(0) + run.first;
  for (int k = 0; k < run.count; ++k) {
    if (rigid_mass[k] == 0.0) continue;
    std::array<int, dim> node = run.node;
    node[0] += k;
    if (rigid_mass[k] >= smallest_mass_share * cell_volume<dim>(m_grid, node))
      add_touching(run.first + k, node, m_body->locate(m_grid.position(node)).normal);
  }
}

template <int dim>
void RigidContact<dim>::add_touching(int local, const std::array<int, dim>& node,
                                     const Vector<dim>& surface_normal) {
  if (m_votes && m_votes->values(0)[local] <= round_off) return;
  const auto normal = normal_at(local, surface_normal);
  if (!normal) return;
  const double full_cell = m_options.reference_density * cell_volume<dim>(m_grid, node);
  m_touching_nodes.push_back({local, smallest_mass_share * full_cell, *normal,
                              m_body->from_reference(m_grid.position(node))});
}

template <int dim>
std::optional<Vector<dim>> RigidContact<dim>::normal_at(int local,
                                                        const Vector<dim>& surface_normal) const {
  if (m_options.normal == Normal::surface) return surface_normal;
  Vector<dim> outward;
  for (int d = 0; d < dim; ++d) outward[d] = m_rigid_mass.values(1 + d)[local];
  const double length = std::sqrt(dot<dim>(outward, outward));
  if (length == 0.0) return std::nullopt;
  for (double& component : outward) component /= length;
  return outward;
}

template <int dim>
void RigidContact<dim>::constrain(const grid::Grid<dim>&, grid::ConstrainedNodes<dim>& nodes) {
  for (const TouchingNode& node : m_touching_nodes) {
    const double m_I = nodes.mass(node.local);
    if (m_I != 0.0 && m_I >= node.smallest_mass) constrain(node, nodes);
  }
}

template <int dim>
void RigidContact<dim>::constrain(const TouchingNode& node, grid::ConstrainedNodes<dim>& nodes) {
  const double m_I = nodes.mass(node.local);
  const Vector<dim> v = m_body->velocity_at(node.lever);
  Vector<dim> relative;
  for (int d = 0; d < dim; ++d) relative[d] = nodes.momentum(node.local, d) / m_I - v[d];
  if (dot<dim>(relative, node.normal) >= 0.0) return;
  nodes.change_velocity(node.local, m_friction->velocity_change(relative, node.normal), v);
  if (nodes.is_momentum_update())
    m_body->meter().add_moment(node.lever, booking().changes.back().momentum);
}

template class RigidContact<1>;
template class RigidContact<2>;
template class RigidContact<3>;

}  // namespace mpm::contact
