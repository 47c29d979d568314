#include <array>

#include "ExplicitStep.hpp"
#include "mpm/basis/Bases.hpp"

namespace mpm::solver {
namespace {

/// Sum of term(first) and `count` - 1 terms after it, in four partial sums that are added side by
/// side.
template <class Term>
double sum_over(int first, int count, const Term& term) {
  std::array<double, 4> part{};
  const int last = first + count, last_of_fours = first + count / 4 * 4;
  for (int i = first; i < last_of_fours; i += 4)
    for (int k = 0; k < 4; ++k) part[static_cast<std::size_t>(k)] += term(i + k);
  for (int i = last_of_fours; i < last; ++i) part[0] += term(i);
  return (part[0] + part[2]) + (part[1] + part[3]);
}

}  // namespace

/// v_I of the middle of the step, with which works are taken.
template <int dim, class Basis>
double ExplicitStep<dim, Basis>::mean_velocity(int d, int I, double dt) const {
  return m_rates.values(d)[I] - 0.5 * dt * m_rates.values(dim + d)[I];
}

/// Impulses of gravity or another body force, and of loads: all that deposited forces sum up to,
/// since internal ones sum to zero.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_deposits(double dt) {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  Cause<dim>& gravity = m_parts.ledger.cause("gravity");
  Cause<dim>& loads = m_parts.ledger.cause("loads");
  double mass = 0.0;
  Vector<dim> force{};
  m_parts.grid.for_each_active_run([&](int I, int count) {
    if (m_body_force.is_uniform())
      mass += sum_over(I, count, [&](int i) { return sums.mass[i]; });
    else
      for (int d = 0; d < dim; ++d)
        force[d] += sum_over(I, count, [&](int i) { return sums.force[d][i]; });
  });
  for (int d = 0; d < dim; ++d) loads.impulse[d] += m_load[d] * dt;
  for (int d = 0; d < dim; ++d)
    gravity.impulse[d] +=
        (m_body_force.is_uniform() ? mass * m_body_force.uniform()[d] : force[d] - m_load[d]) * dt;
}

/// With the pair of a node I and its twin b beyond a wall, of which the twin moves against it in a
/// held component, the wall gives the particles -2 (f_b dt + s m_b a_I dt + (1 - s)(p_b + m_b
/// v_I)), s the FLIP share; on the wall itself -(f dt + (1 - s) p), and what constraints put there.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_walls(double flip_share, double dt) {
  std::array<Vector<dim>, 2 * dim> impulse{};
  const auto component_of = [&](const auto& held) -> double& {
    return impulse[static_cast<std::size_t>(held.wall)][static_cast<std::size_t>(held.component)];
  };
  for (const auto& held : m_folded) {
    const double rest = 1.0 - flip_share;
    if (held.reflection < 0) {
      component_of(held) -= held.force * dt + rest * held.momentum;
      continue;
    }
    const double v = m_rates.values(held.component)[held.reflection];
    const double a = m_rates.values(dim + held.component)[held.reflection];
    component_of(held) -= 2.0 * (held.force * dt + flip_share * held.mass * a * dt +
                                 rest * (held.momentum + held.mass * v));
  }
  for (const auto& held : m_held) component_of(held) -= held.force * dt;
  for (int wall = 0; wall < 2 * dim; ++wall) {
    if (m_parts.walls.kind(wall / 2, wall % 2) == grid::Wall::free) continue;
    Vector<dim>& booked = m_parts.ledger.cause(wall_cause(wall)).impulse;
    for (int d = 0; d < dim; ++d) booked[d] += impulse[static_cast<std::size_t>(wall)][d];
  }
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_constraints(double dt) {
  for (auto* constraint : m_parts.constraints) {
    Cause<dim>& cause = m_parts.ledger.cause(constraint->label());
    for (const auto& [I, given] : constraint->booking().changes)
      for (int d = 0; d < dim; ++d) {
        cause.impulse[d] += given[d];
        cause.work += given[d] * mean_velocity(d, I, dt);
      }
    cause.body_work += constraint->booking().work;
  }
  if (m_undamped[0].empty()) return;
  Cause<dim>& damping = m_parts.ledger.cause("damping");
  const transfer::MassMomentumForce<dim> sums(m_sums);
  m_parts.grid.for_each_active_run([&](int first, int count) {
    for (int d = 0; d < dim; ++d)
      for (int I = first; I < first + count; ++I) {
        const double given = sums.momentum[d][I] - m_undamped[d][static_cast<std::size_t>(I)];
        damping.impulse[d] += given;
        damping.work += given * mean_velocity(d, I, dt);
      }
  });
  for (auto& momentum : m_undamped) momentum.clear();
}

/// Of all forces together, and of uniform gravity: that of the twins beyond a wall acts against
/// their reflections in held components.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_work(double dt) {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  const transfer::VelocityAcceleration<dim> rates(m_rates);
  double of_forces = 0.0;
  Vector<dim> of_mass{};
  m_parts.grid.for_each_active_run([&](int I, int count) {
    for (int d = 0; d < dim; ++d) {
      const double *const f = sums.force[d], *const v = rates.velocity[d],
                          *const a = rates.acceleration[d];
      of_forces += sum_over(I, count, [=](int i) { return f[i] * (v[i] - 0.5 * dt * a[i]); });
      if (m_body_force.is_uniform() && m_body_force.uniform()[d] != 0.0)
        of_mass[d] += sum_over(
            I, count, [=, m = sums.mass](int i) { return m[i] * (v[i] - 0.5 * dt * a[i]); });
    }
  });
  m_parts.ledger.add_total_work(of_forces * dt);
  if (!m_body_force.is_uniform()) return;
  for (const auto& held : m_folded)
    if (held.reflection >= 0)
      of_mass[static_cast<std::size_t>(held.component)] -=
          2.0 * held.mass * mean_velocity(held.component, held.reflection, dt);
  for (int d = 0; d < dim; ++d)
    m_parts.ledger.cause("gravity").work += m_body_force.uniform()[d] * of_mass[d] * dt;
}

/// What a load gives to nodes without mass, as continued functions of uGIMP do, reaches no
/// particle.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_loads_work(double dt) {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  m_parts.grid.for_each_active_run([&](int first, int count) {
    for (int I = first; I < first + count; ++I)
      if (sums.mass[I] == 0.0)
        for (int d = 0; d < dim; ++d)
          m_parts.ledger.cause("loads").impulse[d] -= sums.force[d][I] * dt;
  });
  m_parts.ledger.cause("loads").work +=
      dt * transfer::surface_load_power<dim, Basis>(m_parts.boundary.view(), stencil(), dt,
                                                    transfer::VelocityAcceleration<dim>(m_rates));
}

/// At the particles: a sum over nodes, among them those beyond walls, which move as their twins do.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_body_force_work(const View& particles, double dt) {
  m_parts.ledger.cause("gravity").work +=
      dt * transfer::body_force_power<dim, Basis>(particles, stencil(), m_body_force, dt,
                                                  transfer::VelocityAcceleration<dim>(m_rates));
}

#define MPM_INSTANTIATE(dim, Basis)                                                \
  template double ExplicitStep<dim, Basis>::mean_velocity(int, int, double) const; \
  template void ExplicitStep<dim, Basis>::book_deposits(double);                   \
  template void ExplicitStep<dim, Basis>::book_walls(double, double);              \
  template void ExplicitStep<dim, Basis>::book_constraints(double);                \
  template void ExplicitStep<dim, Basis>::book_work(double);                       \
  template void ExplicitStep<dim, Basis>::book_loads_work(double);                 \
  template void ExplicitStep<dim, Basis>::book_body_force_work(                    \
      const particles::ParticleView<dim>&, double);
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::solver
