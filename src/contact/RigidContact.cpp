#include "mpm/contact/RigidContact.hpp"

#include <cmath>
#include <utility>

#include "ScalarAndGradient.hpp"

namespace mpm::contact {
namespace {

template <int dim>
double dot(const Vector<dim>& a, const Vector<dim>& b) {
  double sum = 0.0;
  for (int d = 0; d < dim; ++d) sum += a[d] * b[d];
  return sum;
}

}  // namespace

template <int dim>
RigidContact<dim>::RigidContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
                                const transfer::PointDeposit<dim>& deposit,
                                std::shared_ptr<RigidBody<dim>> body, const ContactOptions& options)
    : m_grid(grid),
      m_body(std::move(body)),
      m_options(options),
      m_friction(make_friction<dim>(options.friction_law, {.coefficient = options.friction})),
      m_rigid_mass(grid, walls, deposit, *m_body),
      m_detection(make_detection<dim>(
          options.detection,
          {grid, walls, deposit, *m_body, m_rigid_mass, options.gap_cells, m_particles})) {}

/// Where the bodies touch does not depend on their motion: once for both mappings of a step.
template <int dim>
void RigidContact<dim>::find_nodes() {
  m_rigid_mass.forget();
  m_detection->prepare();
  if (m_options.normal == Normal::gradient) m_rigid_mass.provide();
  m_near_nodes.clear();
  for (const grid::Run<dim>& run : m_grid.active_runs()) m_detection->find(run, m_near_nodes);
  m_touching_nodes.clear();
  for (const NearNode<dim>& near : m_near_nodes) add(near);
}

/// Unless it has no normal.
template <int dim>
void RigidContact<dim>::add(const NearNode<dim>& near) {
  const auto normal = m_options.normal == Normal::surface ? std::optional(near.surface_normal)
                                                          : m_rigid_mass.normal(near.local);
  if (!normal) return;
  const double full_cell = m_options.reference_density * cell_volume<dim>(m_grid, near.node);
  m_touching_nodes.push_back({near.local, smallest_mass_share * full_cell, *normal,
                              m_body->from_reference(m_grid.position(near.node))});
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
