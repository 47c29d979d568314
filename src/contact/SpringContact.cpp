#include "mpm/contact/SpringContact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mpm::contact {
namespace {

constexpr double stiffness = 1.0;       // k dt^2/m_p
constexpr double dashpot_share = 0.25;  // of the critical one of a particle on its spring

constexpr int tensor_index[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

template <int dim>
double dot(const Vector<dim>& a, const Vector<dim>& b) {
  double sum = 0.0;
  for (int d = 0; d < dim; ++d) sum += a[d] * b[d];
  return sum;
}

/// a + s b.
template <int dim>
Vector<dim> sum(Vector<dim> a, double s, const Vector<dim>& b) {
  for (int d = 0; d < dim; ++d) a[d] += s * b[d];
  return a;
}

template <int dim>
Vector<dim> product(const SymmetricTensor& tensor, const Vector<dim>& n) {
  Vector<dim> result{};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) result[i] += tensor[tensor_index[i][j]] * n[j];
  return result;
}

template <int dim>
Vector<dim> vector_of(const particles::ParticleView<dim>& view, particles::StateHandle field,
                      int p) {
  Vector<dim> value;
  for (int d = 0; d < dim; ++d) value[d] = view.column(field, d)[p];
  return value;
}

template <int dim>
void set_vector(const particles::ParticleView<dim>& view, particles::StateHandle field, int p,
                const Vector<dim>& value) {
  for (int d = 0; d < dim; ++d) view.column(field, d)[p] = value[d];
}

/// From a particle's centre to its own surface along the unit vector n.
template <int dim>
double half_extent(const particles::ParticleView<dim>& view, int p, const Vector<dim>& n) {
  SymmetricTensor A;
  for (int k = 0; k < tensor_components<dim>; ++k)
    A[k] = view.extent[static_cast<std::size_t>(k)][p];
  return std::sqrt(std::max(0.0, dot<dim>(n, product<dim>(A, n))));
}

/// Largest half extent of a particle in any direction, or more.
template <int dim>
double largest_half_extent(const particles::ParticleView<dim>& view, int p) {
  double trace = 0.0;
  for (int d = 0; d < dim; ++d) trace += view.extent[static_cast<std::size_t>(d)][p];
  return std::sqrt(trace);
}

template <int dim>
double largest_speed(const particles::ParticleView<dim>& view) {
  double square = 0.0;
  for (int p = 0; p < view.count; ++p) {
    double sum = 0.0;
    for (int d = 0; d < dim; ++d) sum += view.velocity[d][p] * view.velocity[d][p];
    square = std::max(square, sum);
  }
  return std::sqrt(square);
}

template <int dim>
std::vector<grid::Component> vector_components() {
  std::vector<grid::Component> components;
  for (int d = 0; d < dim; ++d) components.push_back({d});
  return components;
}

}  // namespace

/// A particle that touches, before and after a step. Vectors in space, N and m.
template <int dim>
struct SpringContact<dim>::Touch {
  Vector<dim> normal;
  Vector<dim> last_force;
  Vector<dim> moved;  ///< relative to the body
  double closed;      ///< growth of the overlap
  double k;           ///< N/m
};

template <int dim>
SpringContact<dim>::SpringContact(const grid::Grid<dim>& grid, const grid::Walls<dim>& walls,
                                  const transfer::PointDeposit<dim>& deposit,
                                  const particles::Particles<dim>& particles,
                                  std::shared_ptr<RigidBody<dim>> body,
                                  const ContactOptions& options)
    : m_grid(grid),
      m_walls(walls),
      m_deposit(deposit),
      m_particles(particles),
      m_body(std::move(body)),
      m_options(options),
      m_friction(make_friction<dim>(options.friction_law, {.coefficient = options.friction})),
      m_force(particles.fields().handle(options.label + "_force")),
      m_place(particles.fields().handle(options.label + "_place")),
      m_overlap(particles.fields().handle(options.label + "_overlap")),
      m_reach(particles.fields().handle(options.label + "_reach")),
      m_nodal_force(grid, vector_components<dim>()) {}

template <int dim>
void SpringContact<dim>::look_at_particles(double dt) {
  m_points.clear();
  m_forces.clear();
  const View view = m_particles.view();
  renew_watched(view, dt);
  for (const int p : m_watched) look_at(view, p, dt);
}

/// Particles further away than they and the body can go are left out until they may be near.
template <int dim>
void SpringContact<dim>::renew_watched(const View& view, double dt) {
  double body_speed = std::sqrt(dot<dim>(m_body->velocity, m_body->velocity));
  if (m_body->spin != 0.0) m_way_left = 0.0;
  m_way_left -= (largest_speed(view) + body_speed) * dt;
  if (m_way_left > 0.0 && m_watched_order == m_particles.order()) return;
  m_watched.clear();
  m_watched_order = m_particles.order();
  double largest = 0.0;
  for (int p = 0; p < view.count; ++p) largest = std::max(largest, largest_half_extent(view, p));
  m_way_left = largest;
  for (int p = 0; p < view.count; ++p)
    if (m_body->locate(view.position_of(p)).distance <
        m_way_left + 2.0 * largest_half_extent(view, p))
      m_watched.push_back(p);
}

template <int dim>
void SpringContact<dim>::look_at(const View& view, int p, double dt) {
  const geometry::Proximity<dim> surface = m_body->locate(view.position_of(p));
  if (std::isnan(view[m_overlap][p])) begin(view, p, surface);
  const double overlap =
      view[m_reach][p] * half_extent<dim>(view, p, surface.normal) - surface.distance;
  const double last_overlap = std::exchange(view[m_overlap][p], overlap);
  const Vector<dim> place = m_body->in_body_frame(view.position_of(p));
  const Vector<dim> last_place = vector_of<dim>(view, m_place, p);
  const Vector<dim> last_force = vector_of<dim>(view, m_force, p);
  set_vector<dim>(view, m_place, p, place);
  set_vector<dim>(view, m_force, p, {});
  const bool touched = dot<dim>(last_force, surface.normal) > 0.0;
  if (!touched && overlap <= 0.0) return;
  const Touch touch{
      .normal = surface.normal,
      .last_force = last_force,
      .moved = touched ? m_body->turned_to_space(sum<dim>(place, -1.0, last_place)) : Vector<dim>{},
      .closed = overlap - (touched ? last_overlap : std::max(last_overlap, 0.0)),
      .k = stiffness * view.mass[p] / (dt * dt)};
  const Vector<dim> force = held_by_springs(touch);
  set_vector<dim>(view, m_force, p, force);
  const double pressing = dot<dim>(force, surface.normal);
  const double c_dt = 2.0 * dashpot_share / std::sqrt(stiffness) * touch.k;
  const double dashpot = pressing > 0.0 ? std::max(-pressing, c_dt * touch.closed) : 0.0;
  m_points.push_back(view.position_of(p));
  m_forces.push_back(sum<dim>(force, dashpot, surface.normal));
}

/// The friction law limits the springs' force as it limits a velocity that would be taken away.
template <int dim>
Vector<dim> SpringContact<dim>::held_by_springs(const Touch& touch) const {
  const Vector<dim>& n = touch.normal;
  const double pressing = dot<dim>(touch.last_force, n) + touch.k * touch.closed;
  if (pressing <= 0.0) return {};
  const Vector<dim> last_shear = sum<dim>(touch.last_force, -dot<dim>(touch.last_force, n), n);
  const Vector<dim> slid = sum<dim>(touch.moved, -dot<dim>(touch.moved, n), n);
  const Vector<dim> shear = sum<dim>(last_shear, -touch.k, slid);
  Vector<dim> against;
  for (int d = 0; d < dim; ++d) against[d] = -pressing * n[d] - shear[d];
  return m_friction->velocity_change(against, n);
}

/// A particle that is seen for the first time. Its soil ends at the surface where its extent would
/// pass it; where it carries a pressure, that of the first layer reaches up to the surface.
template <int dim>
void SpringContact<dim>::begin(const View& view, int p,
                               const geometry::Proximity<dim>& surface) const {
  const auto& [distance, n] = surface;
  const double half = half_extent<dim>(view, p, n);
  const Vector<dim> traction = product<dim>(view.stress_of(p), n);
  const bool carries = distance <= 2.0 * half && dot<dim>(traction, n) < 0.0;
  const bool reaches = distance < half || carries;
  set_vector<dim>(view, m_place, p, m_body->in_body_frame(view.position_of(p)));
  view[m_reach][p] = reaches ? std::max(distance, 0.0) / half : 1.0;
  view[m_overlap][p] = view[m_reach][p] * half - distance;
  if (!carries) return;
  const double area = view.volume[p] / (2.0 * half);
  Vector<dim> against;
  for (int d = 0; d < dim; ++d) against[d] = traction[d] * area;
  set_vector<dim>(view, m_force, p, m_friction->velocity_change(against, n));
}

template <int dim>
void SpringContact<dim>::find_nodes() {
  m_nodal_force.set_active_to_zero();
  m_deposit.deposit_vectors(m_points, m_forces, m_nodal_force);
  m_nodal_force.sum_to_owners();
  m_walls.fold(m_grid, m_nodal_force);
}

/// The remapped momentum of Eq. 9 is of particles that have felt the force.
template <int dim>
void SpringContact<dim>::constrain(const grid::Grid<dim>&, grid::ConstrainedNodes<dim>& nodes) {
  if (!nodes.is_momentum_update()) return;
  for (const grid::Run<dim>& run : m_grid.active_runs())
    for (int k = 0; k < run.count; ++k) {
      const int I = run.first + k;
      Vector<dim> impulse;
      for (int d = 0; d < dim; ++d) impulse[d] = m_nodal_force.values(d)[I] * nodes.dt();
      if (impulse == Vector<dim>{} || nodes.mass(I) == 0.0) continue;
      std::array<int, dim> node = run.node;
      node[0] += k;
      const Vector<dim> lever = m_body->from_reference(m_grid.position(node));
      nodes.add_momentum(I, impulse, m_body->velocity_at(lever));
      m_body->meter().add_moment(lever, impulse);
    }
}

/// The step in which a particle is seen for the first time depends on who is watched.
template <int dim>
void SpringContact<dim>::persist(Archive& archive) {
  grid::Constraint<dim>::persist(archive);
  bool is_current = m_watched_order == m_particles.order();
  std::vector<double> watched(m_watched.begin(), m_watched.end());
  archive.own("is_current", is_current);
  archive.own("watched", watched);
  archive.own("way_left", m_way_left);
  if (!archive.gives()) return;
  m_watched.clear();
  for (const double p : watched) m_watched.push_back(static_cast<int>(p));
  m_watched_order = is_current ? m_particles.order() : -1;
}

template class SpringContact<1>;
template class SpringContact<2>;
template class SpringContact<3>;

}  // namespace mpm::contact
