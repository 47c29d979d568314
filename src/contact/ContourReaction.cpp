#include "mpm/contact/ContourReaction.hpp"

#include <algorithm>
#include <utility>

namespace mpm::contact {
namespace {

template <int dim>
Vector<dim> traction(const particles::ParticleView<dim>& particles, int p,
                     const Vector<dim>& direction) {
  const auto& s = particles.stress;
  if constexpr (dim == 2)
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
  Vector<dim> force{};
  const double width = m_band.outer - m_band.inner;
  for (int p = 0; p < particles.count; ++p) {
    const Proximity<dim> place = body.locate(particles.position_of(p));
    if (place.distance >= m_band.outer) continue;
    const Cutoff chi_p = cutoff(share_of_band(place.distance));
    const double chi = chi_p.value;
    const double m = particles.mass[p];
    for (int d = 0; d < dim; ++d) {
      m_momentum[d] += m * particles.velocity[d][p] * chi;
      force[d] += m * gravity[d] * chi;
    }
    if (chi_p.slope == 0.0) continue;
    const Vector<dim> t = traction<dim>(particles, p, place.normal);
    double outflow = 0.0;
    for (int d = 0; d < dim; ++d)
      outflow += (particles.velocity[d][p] - body.velocity[d]) * place.normal[d];
    for (int d = 0; d < dim; ++d)
      force[d] += (m * particles.velocity[d][p] * outflow - particles.volume[p] * t[d]) *
                  chi_p.slope / width;
  }
  for (int d = 0; d < dim; ++d) m_force_time[d] += force[d] * dt;
  m_time += dt;
}

template <int dim>
void ContourReaction<dim>::sample_surface(const particles::BoundaryView<dim>& boundary,
                                          const RigidBody<dim>& body, double dt) {
  for (int b = 0; b < boundary.count; ++b) {
    const Proximity<dim> place = body.locate(boundary.position_of(b));
    if (place.distance >= m_band.outer) continue;
    const double chi = cutoff(share_of_band(place.distance)).value;
    for (int d = 0; d < dim; ++d)
      m_force_time[d] -= boundary.pressure[b] * boundary.area[d][b] * chi * dt;
  }
}

template <int dim>
Vector<dim> ContourReaction<dim>::take_mean(const petsc::Communicator& communicator) {
  Vector<dim> mean{};
  for (int d = 0; d < dim; ++d) {
    const double last = communicator.sum(m_momentum[d]);
    const double change = m_has_start ? last - m_first_momentum[d] : 0.0;
    m_first_momentum[d] = last;
    const double total = communicator.sum(std::exchange(m_force_time[d], 0.0));
    if (m_time > 0.0) mean[d] = (total - change) / m_time;
  }
  m_has_start = true;
  m_time = 0.0;
  return mean;
}

template class ContourReaction<2>;
template class ContourReaction<3>;

}  // namespace mpm::contact
