#include <numeric>

#include "ExplicitStep.hpp"
#include "mpm/basis/Bases.hpp"

namespace mpm::solver {
/// v_I of the middle of the step, with which works are taken.
template <int dim, class Basis>
double ExplicitStep<dim, Basis>::mean_velocity(int d, int I, double dt) const {
  return m_rates.values(d)[I] - 0.5 * dt * m_rates.values(dim + d)[I];
}

/// Impulses of gravity or another body force, and of loads: all that deposited forces sum up to,
/// since internal ones sum to zero.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_deposits(const StepOptions<dim>& options, double dt) {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  Cause<dim>& body_force = m_parts.ledger.cause("gravity");
  double mass = 0.0;
  Vector<dim> force{};
  m_parts.grid.for_each_active_run([&](int I, int count) {
    mass = std::accumulate(sums.mass + I, sums.mass + I + count, mass);
    if (options.body_force.at_reference_position)
      for (int d = 0; d < dim; ++d)
        force[d] = std::accumulate(sums.force[d] + I, sums.force[d] + I + count, force[d]);
  });
  for (int d = 0; d < dim; ++d) m_parts.ledger.cause("loads").impulse[d] += m_load[d] * dt;
  for (int d = 0; d < dim; ++d)
    body_force.impulse[d] += options.body_force.at_reference_position
                                 ? (force[d] - m_load[d]) * dt
                                 : mass * options.body_force.uniform[d] * dt;
}

/// With the pair of a node I and its twin b beyond a wall, of which the twin moves against it in a
/// held component, the wall gives the particles -2 (f_b dt + s m_b a_I dt + (1 - s)(p_b + m_b
/// v_I)), s the FLIP share; on the wall itself -(f dt + (1 - s) p), and what constraints put there.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::book_walls(double flip_share, double dt) {
  for (const auto& held : m_folded) {
    double& impulse = m_parts.ledger.cause(wall_cause(held.wall))
                          .impulse[static_cast<std::size_t>(held.component)];
    const double rest = 1.0 - flip_share;
    if (held.reflection < 0) {
      impulse -= held.force * dt + rest * held.momentum;
      continue;
    }
    const double v = m_rates.values(held.component)[held.reflection];
    const double a = m_rates.values(dim + held.component)[held.reflection];
    impulse -= 2.0 * (held.force * dt + flip_share * held.mass * a * dt +
                      rest * (held.momentum + held.mass * v));
  }
  for (const auto& held : m_held)
    m_parts.ledger.cause(wall_cause(held.wall)).impulse[static_cast<std::size_t>(held.component)] -=
        held.force * dt;
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
void ExplicitStep<dim, Basis>::book_work(const StepOptions<dim>& options, double dt) {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  const Vector<dim>& g = options.body_force.uniform;
  double total = 0.0, gravity = 0.0;
  m_parts.grid.for_each_active_run([&](int first, int count) {
    for (int d = 0; d < dim; ++d) {
      double of_forces = 0.0, of_mass = 0.0;
      for (int I = first; I < first + count; ++I) {
        const double v = mean_velocity(d, I, dt);
        of_forces += sums.force[d][I] * v;
        of_mass += sums.mass[I] * v;
      }
      total += of_forces;
      gravity += g[d] * of_mass;
    }
  });
  for (const auto& held : m_folded)
    if (held.reflection >= 0)
      gravity -= 2.0 * held.mass * g[static_cast<std::size_t>(held.component)] *
                 mean_velocity(held.component, held.reflection, dt);
  m_parts.ledger.add_total_work(total * dt);
  if (!options.body_force.at_reference_position)
    m_parts.ledger.cause("gravity").work += gravity * dt;
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
void ExplicitStep<dim, Basis>::book_body_force_work(const View& particles,
                                                    const StepOptions<dim>& options, double dt) {
  m_parts.ledger.cause("gravity").work +=
      dt * transfer::body_force_power<dim, Basis>(particles, stencil(), options.body_force, dt,
                                                  transfer::VelocityAcceleration<dim>(m_rates));
}

#define MPM_INSTANTIATE(dim, Basis)                                                       \
  template double ExplicitStep<dim, Basis>::mean_velocity(int, int, double) const;        \
  template void ExplicitStep<dim, Basis>::book_deposits(const StepOptions<dim>&, double); \
  template void ExplicitStep<dim, Basis>::book_walls(double, double);                     \
  template void ExplicitStep<dim, Basis>::book_constraints(double);                       \
  template void ExplicitStep<dim, Basis>::book_work(const StepOptions<dim>&, double);     \
  template void ExplicitStep<dim, Basis>::book_loads_work(double);                        \
  template void ExplicitStep<dim, Basis>::book_body_force_work(                           \
      const particles::ParticleView<dim>&, const StepOptions<dim>&, double);
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::solver
