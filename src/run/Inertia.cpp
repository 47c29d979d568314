#include "mpm/run/Inertia.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::run {
namespace {

constexpr long long steps_between_looks = 20;

template <int dim>
double size(const Vector<dim>& v) {
  double square = 0.0;
  for (const double component : v) square += component * component;
  return std::sqrt(square);
}

}  // namespace

template <int dim>
void Inertia<dim>::begin_stage(const Moment<dim>& now) {
  m_work = now.simulation.ledger().work_of_bodies.value_or(0.0);
  m_way = m_time = 0.0;
  m_force = m_options.smallest_force;
}

template <int dim>
void Inertia<dim>::after_step(const Moment<dim>& now) {
  m_way += size<dim>(m_body->velocity) * now.clock.dt;
  m_time += now.clock.dt;
  if (now.clock.steps_in_stage % steps_between_looks == 0) look(now);
}

template <int dim>
void Inertia<dim>::look(const Moment<dim>& now) {
  const double work = now.simulation.ledger().work_of_bodies.value_or(0.0);
  const double kinetic_energy = now.simulation.kinetic_energy();
  if (m_way > 0.0) m_force = std::max(m_options.smallest_force, (work - m_work) / m_way);
  m_share = kinetic_energy / (m_force * m_options.length);
  if (m_motion)
    m_motion->speed += (allowed_speed(kinetic_energy) - m_motion->speed) *
                       (1.0 - std::exp(-m_time / m_options.time));
  m_work = work;
  m_way = m_time = 0.0;
}

template <int dim>
double Inertia<dim>::allowed_speed(double kinetic_energy) const {
  const double v = m_motion->speed;
  const double moving_mass =
      std::max(m_options.smallest_mass, v > 0.0 ? 2.0 * kinetic_energy / (v * v) : 0.0);
  return std::sqrt(2.0 * m_options.tolerance * m_force * m_options.length / moving_mass);
}

template <int dim>
void Inertia<dim>::persist(Archive& archive) {
  archive("work", m_work);
  archive("way", m_way);
  archive("time", m_time);
  archive("force", m_force);
  archive("share", m_share);
  if (m_motion) archive("speed", m_motion->speed);
}

template class Inertia<1>;
template class Inertia<2>;
template class Inertia<3>;

}  // namespace mpm::run
