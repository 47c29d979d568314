#include "mpm/contact/ContourReaction.hpp"

namespace mpm::contact {
namespace {

template <int dim>
Vector<dim> traction(const particles::ParticleView<dim>& particles, int p,
                     const Vector<dim>& direction) {
  const auto& s = particles.stress;
  if constexpr (dim == 1)
    return {s[0][p] * direction[0]};
  else if constexpr (dim == 2)
    return {s[0][p] * direction[0] + s[3][p] * direction[1],
            s[3][p] * direction[0] + s[1][p] * direction[1]};
  else
    return {s[0][p] * direction[0] + s[3][p] * direction[1] + s[5][p] * direction[2],
            s[3][p] * direction[0] + s[1][p] * direction[1] + s[4][p] * direction[2],
            s[5][p] * direction[0] + s[4][p] * direction[1] + s[2][p] * direction[2]};
}

struct Cutoff {
  double value;
  double slope;  ///< d chi/ds
};

/// 1 - 3 s^2 + 2 s^3: as smooth as a sum over particles needs to be close to the integral.
Cutoff cutoff(double s) {
  if (s <= 0.0) return {1.0, 0.0};
  return {1.0 - s * s * (3.0 - 2.0 * s), -6.0 * s * (1.0 - s)};
}

}  // namespace

template <int dim>
void ContourReaction<dim>::sample(const particles::ParticleView<dim>& particles,
                                  const RigidBody<dim>& body, const Vector<dim>& gravity,
                                  double dt) {
  m_momentum = {};
  BodyForce<dim> total;
  const double width = m_band.outer - m_band.inner;
  for (int p = 0; p < particles.count; ++p) {
    const Vector<dim> x = particles.position_of(p);
    const geometry::Proximity<dim> place = body.locate(x);
    if (place.distance >= m_band.outer) continue;
    const Cutoff chi_p = cutoff(share_of_band(place.distance));
    const double chi = chi_p.value;
    const double m = particles.mass[p];
    const Vector<dim> r = body.from_reference(x), v = particles.velocity_of(p);
    Vector<dim> momentum, force;
    for (int d = 0; d < dim; ++d) {
      momentum[d] = m * v[d] * chi;
      force[d] = m * gravity[d] * chi;
    }
    add(m_momentum, r, momentum);
    total.moment -= moment_of<dim>(body.velocity, momentum);
    add(total, r, force);
    if (chi_p.slope == 0.0) continue;
    const Vector<dim> t = traction<dim>(particles, p, place.normal);
    const Vector<dim> w = body.velocity_at(r);
    double outflow = 0.0;
    for (int d = 0; d < dim; ++d) outflow += (v[d] - w[d]) * place.normal[d];
    for (int d = 0; d < dim; ++d)
      force[d] = (m * v[d] * outflow - particles.volume[p] * t[d]) * chi_p.slope / width;
    add(total, r, force);
  }
  for (int d = 0; d < dim; ++d) m_force_time.force[d] += total.force[d] * dt;
  m_force_time.moment += total.moment * dt;
  m_time += dt;
}

template <int dim>
void ContourReaction<dim>::sample_surface(const particles::BoundaryView<dim>& boundary,
                                          const RigidBody<dim>& body, double dt) {
  for (int b = 0; b < boundary.count; ++b) {
    const Vector<dim> x = boundary.position_of(b);
    const geometry::Proximity<dim> place = body.locate(x);
    if (place.distance >= m_band.outer) continue;
    const double chi = cutoff(share_of_band(place.distance)).value;
    Vector<dim> impulse;
    for (int d = 0; d < dim; ++d)
      impulse[d] = -boundary.pressure[b] * boundary.area[d][b] * chi * dt;
    add(m_force_time, body.from_reference(x), impulse);
  }
}

template <int dim>
double ContourReaction<dim>::mean_of(double force_time, double momentum, double& first_momentum,
                                     const petsc::Communicator& communicator) const {
  const double last = communicator.sum(momentum);
  const double change = m_has_start ? last - first_momentum : 0.0;
  first_momentum = last;
  const double total = communicator.sum(force_time);
  return m_time > 0.0 ? (total - change) / m_time : 0.0;
}

template <int dim>
BodyForce<dim> ContourReaction<dim>::take_mean(const petsc::Communicator& communicator) {
  BodyForce<dim> mean;
  for (int d = 0; d < dim; ++d)
    mean.force[d] = mean_of(m_force_time.force[d], m_momentum.force[d], m_first_momentum.force[d],
                            communicator);
  mean.moment =
      mean_of(m_force_time.moment, m_momentum.moment, m_first_momentum.moment, communicator);
  m_force_time = {};
  m_has_start = true;
  m_time = 0.0;
  return mean;
}

template class ContourReaction<1>;
template class ContourReaction<2>;
template class ContourReaction<3>;

}  // namespace mpm::contact
