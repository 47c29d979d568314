#include "ExplicitStep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/basis/Bases.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/petsc/Log.hpp"

namespace mpm::solver {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double sign(double value) {
  return value > 0.0 ? 1.0 : (value < 0.0 ? -1.0 : 0.0);
}

// Loops over a run of nodes. Dividing by infinity, not around a branch, lets them be vectorised.

/// 1/m, and 0 where there is no mass.
void invert(const double* __restrict mass, int count, double* __restrict inverse) {
  for (int i = 0; i < count; ++i) inverse[i] = 1.0 / (mass[i] > 0.0 ? mass[i] : infinite);
}

void add_product(const double* __restrict a, double b, int count, double* __restrict sum) {
  for (int i = 0; i < count; ++i) sum[i] += a[i] * b;
}

void multiply(const double* __restrict a, const double* __restrict b, int count,
              double* __restrict product) {
  for (int i = 0; i < count; ++i) product[i] = a[i] * b[i];
}

void scale(const double* __restrict factor, int count, double* __restrict value) {
  for (int i = 0; i < count; ++i) value[i] *= factor[i];
}

/// Local damping of force and momentum.
void damp(double damping, double dt, int count, double* __restrict force,
          double* __restrict momentum) {
  for (int i = 0; i < count; ++i) {
    const double before = momentum[i] - force[i] * dt;
    const double change = -damping * std::abs(force[i]) * sign(before);
    force[i] += change;
    momentum[i] += change * dt;
  }
}

}  // namespace

template <int dim, class Basis>
ExplicitStep<dim, Basis>::ExplicitStep(const StepParts<dim, Basis>& parts)
    : m_parts(parts),
      m_point_deposit(m_parts.grid, m_parts.bases),
      m_sums(parts.grid, transfer::MassMomentumForce<dim>::components()),
      m_rates(parts.grid, transfer::VelocityAcceleration<dim>::components()),
      m_remapped(parts.grid, transfer::NodalVector<dim>::components()) {}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::find_mass(const View& particles) {
  if (!m_mass)
    m_mass = std::make_unique<grid::NodalField<dim>>(
        m_parts.grid, std::vector<grid::Component>{{grid::Component::scalar}});
  m_mass->set_active_to_zero();
  transfer::deposit_mass<dim, Basis>(particles, stencil(), m_mass->values(0));
  m_mass->sum_to_owners();
  m_parts.walls.fold(m_parts.grid, *m_mass);
  m_parts.walls.unfold(m_parts.grid, *m_mass);
  m_mass->copy_to_ghosts();
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::deposit(const View& particles, const StepOptions<dim>& options) {
  const petsc::Phase phase("mpm: deposit");
  if constexpr (transfer::DualBasis<Basis>) find_mass(particles);
  const transfer::MassMomentumForce<dim> sums(m_sums);
  m_sums.set_active_to_zero();
  m_body_force.find(options.body_force, particles);
  transfer::deposit_mass_momentum_force<dim, Basis>(particles, stencil(), m_body_force, sums);
  if (options.transfer == Transfer::apic)
    transfer::deposit_affine_momentum<dim, Basis>(particles, stencil(), sums.momentum);
  if (!m_parts.boundary.is_empty())
    m_load = transfer::deposit_surface_load<dim, Basis>(m_parts.boundary.view(), stencil(), sums);
  m_sums.sum_to_owners();
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::update_velocities(const View& particles, const StepTimes& times,
                                                 const StepOptions<dim>& options) {
  const petsc::Phase phase("mpm: update velocities");
  const double dt = times.momentum_dt();
  const transfer::VelocityAcceleration<dim> rates(m_rates);
  transfer::update_velocities<dim, Basis>(particles, stencil(), dt, options.flip_share(dt), rates);
  if (options.transfer == Transfer::apic)
    transfer::gather_velocity_gradient<dim, Basis>(particles, stencil(), rates.velocity);
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::update_velocities_and_remap(const View& particles,
                                                           const StepTimes& times,
                                                           const StepOptions<dim>& options) {
  const petsc::Phase phase("mpm: update velocities");
  const double dt = times.momentum_dt();
  const transfer::VelocityAcceleration<dim> rates(m_rates);
  m_remapped.set_active_to_zero();
  transfer::update_velocities_and_deposit_momentum<dim, Basis>(
      particles, stencil(), dt, options.flip_share(dt), rates, remapped_velocity());
  if (options.transfer == Transfer::apic) {
    transfer::gather_velocity_gradient<dim, Basis>(particles, stencil(), rates.velocity);
    transfer::deposit_affine_momentum<dim, Basis>(particles, stencil(), remapped_velocity().value);
  }
  m_remapped.sum_to_owners();
  constrain_remapped_momentum();
  m_remapped.copy_to_ghosts();
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::take_deposited_velocities() {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  const transfer::NodalVector<dim> remapped = remapped_velocity();
  m_parts.grid.for_each_active_run([&](int I, int count) {
    for (int d = 0; d < dim; ++d) std::copy_n(sums.momentum[d] + I, count, remapped.value[d] + I);
  });
  m_parts.walls.fold(m_parts.grid, m_sums);
  invert_mass();
  for (auto* constraint : m_parts.constraints) constraint->find_nodes();
  constrain_remapped_momentum();
  m_remapped.copy_to_ghosts();
}

namespace {

/// Particles from gathering to their new stress: what they need stays in the first cache.
constexpr int block_size = 256;

void add(const StepReport& part, StepReport& whole) {
  whole.must_migrate |= part.must_migrate;
  if (part.broken_particle >= 0) whole.broken_particle = part.broken_particle;
}

}  // namespace

template <int dim, class Basis>
StepReport ExplicitStep<dim, Basis>::strain_and_move(
    const View& particles, const transfer::AdvanceTimes& dt,
    const transfer::NodalVector<dim>& strain_velocity, const StepOptions<dim>& options) {
  StepReport report;
  if (options.averages() && dt.strain > 0.0) {
    report = strain_with_averages_and_move(particles, dt, strain_velocity,
                                           options.averaged_volume_share);
  } else {
    for (int first = 0; first < particles.count; first += block_size) {
      const int last = std::min(first + block_size, particles.count);
      add(strain_and_move_block(particles, {first, last}, dt, strain_velocity), report);
    }
  }
  if (dt.move > 0.0 && !m_parts.boundary.is_empty())
    report.must_migrate |= transfer::move_surface<dim, Basis>(
                               m_parts.boundary.view(), m_parts.grid, stencil(), dt.move,
                               transfer::VelocityAcceleration<dim>(m_rates), strain_velocity)
                               .must_migrate;
  return report;
}

template <int dim, class Basis>
transfer::Drift ExplicitStep<dim, Basis>::gather(
    const View& particles, const particles::Range& range, const transfer::AdvanceTimes& dt,
    const transfer::NodalVector<dim>& strain_velocity) {
  const petsc::Phase phase("mpm: strain and move");
  return transfer::gather_increments_and_move<dim, Basis>(
      particles, range, stencil(), dt, transfer::VelocityAcceleration<dim>(m_rates),
      strain_velocity, m_parts.grid, m_increments);
}

template <int dim, class Basis>
StepReport ExplicitStep<dim, Basis>::strain_and_move_block(
    const View& particles, const particles::Range& block, const transfer::AdvanceTimes& dt,
    const transfer::NodalVector<dim>& strain_velocity) {
  const transfer::Drift drift = gather(particles, block, dt, strain_velocity);
  const int broken = dt.strain > 0.0 ? update_stress(particles) : -1;
  return {drift.must_migrate, drift.lost >= 0 ? drift.lost : broken};
}

/// Averaging needs the old positions of all particles, so the motion waits.
template <int dim, class Basis>
StepReport ExplicitStep<dim, Basis>::strain_with_averages_and_move(
    const View& particles, const transfer::AdvanceTimes& dt,
    const transfer::NodalVector<dim>& strain_velocity, double share) {
  const particles::Range all{0, particles.count};
  transfer::Drift drift =
      gather(particles, all, {.strain = dt.strain, .move = 0.0}, strain_velocity);
  average_volume_change(particles, share);
  const int broken = update_stress(particles);
  if (dt.move > 0.0)
    drift = gather(particles, all, {.strain = 0.0, .move = dt.move}, strain_velocity);
  return {drift.must_migrate, drift.lost >= 0 ? drift.lost : broken};
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::average_volume_change(const View& particles, double share) {
  const petsc::Phase phase("mpm: average volume change");
  if (!m_volume_change)
    m_volume_change = std::make_unique<grid::NodalField<dim>>(
        m_parts.grid, std::vector<grid::Component>(2, {grid::Component::scalar}));
  grid::NodalField<dim>& field = *m_volume_change;
  double* const volume = field.values(0);
  double* const change = field.values(1);
  field.set_active_to_zero();
  transfer::deposit_volume_change<dim, Basis>(particles, stencil(), m_increments, volume, change);
  field.sum_to_owners();
  m_parts.walls.fold(m_parts.grid, field);
  m_parts.grid.for_each_active_run([&](int first, int count) {
    for (int I = first; I < first + count; ++I) change[I] /= volume[I] > 0.0 ? volume[I] : infinite;
  });
  m_parts.walls.unfold(m_parts.grid, field);
  field.copy_to_ghosts();
  transfer::blend_volume_change<dim, Basis>(particles, stencil(), change, share, m_increments);
}

/// All constraints act on one of the two mappings of a step, each on its own account.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::constrain(grid::ConstrainedNodes<dim> nodes) {
  for (auto* constraint : m_parts.constraints) {
    nodes.book_on(constraint->booking());
    constraint->constrain(m_parts.grid, nodes);
  }
}

/// p_I += f_I dt (Eq. 6) with walls, rigid bodies and damping; then v_I = p_I/m_I, a_I = f_I/m_I.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::update_momentum(const View& particles, const StepTimes& times,
                                               const StepOptions<dim>& options) {
  const petsc::Phase phase("mpm: update momentum");
  const transfer::MassMomentumForce<dim> sums(m_sums);
  const double dt = times.momentum_dt();
  book_deposits(dt);
  m_folded = m_parts.walls.fold_sums(m_parts.grid, m_sums);
  invert_mass();
  m_parts.grid.for_each_active_run([&](int I, int count) {
    for (int d = 0; d < dim; ++d) add_product(sums.force[d] + I, dt, count, sums.momentum[d] + I);
  });
  for (auto* constraint : m_parts.constraints) constraint->find_nodes();
  constrain({sums.mass, sums.momentum, sums.force, dt});
  m_held = m_parts.walls.about_to_hold(m_parts.grid, m_sums);
  m_parts.walls.hold(m_parts.grid, m_sums);
  sum_unbalanced_force();
  if (options.damping > 0.0) apply_damping(options.damping, dt);
  compute_velocity_and_acceleration();
  book_walls(options.flip_share(dt), dt);
  book_constraints(dt);
  book_work(dt);
  m_rates.copy_to_ghosts();
  if (!m_parts.boundary.is_empty()) book_loads_work(dt);
  if (!m_body_force.is_uniform()) book_body_force_work(particles, dt);
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::invert_mass() {
  m_inverse_mass.resize(static_cast<std::size_t>(m_parts.grid.local_size()));
  const double* const mass = m_sums.values(0);
  m_parts.grid.for_each_active_run(
      [&](int I, int count) { invert(mass + I, count, m_inverse_mass.data() + I); });
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::sum_unbalanced_force() {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  double sum = 0.0;
  m_parts.grid.for_each_active_run([&](int first, int count) {
    for (int I = first; I < first + count; ++I) {
      double square = 0.0;
      for (int d = 0; d < dim; ++d) square += sums.force[d][I] * sums.force[d][I];
      sum += std::sqrt(square);
    }
  });
  m_unbalanced_force = sum;
}

/// Local damping of the force that is left after walls and rigid bodies. Nodes in contact are
/// put back as they were: damping there would show up in the reaction.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::apply_damping(double damping, double dt) {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  std::vector<std::pair<double*, double>> undamped;
  for (auto* constraint : m_parts.constraints) {
    if (!constraint->spares_from_damping()) continue;
    for (const auto& [I, given] : constraint->booking().changes)
      for (int d = 0; d < dim; ++d)
        for (double* value : {sums.force[d] + I, sums.momentum[d] + I})
          undamped.emplace_back(value, *value);
  }
  for (int d = 0; d < dim; ++d)
    m_undamped[d].assign(sums.momentum[d], sums.momentum[d] + m_parts.grid.local_size());
  m_parts.grid.for_each_active_run([&](int I, int count) {
    for (int d = 0; d < dim; ++d) damp(damping, dt, count, sums.force[d] + I, sums.momentum[d] + I);
  });
  for (const auto& [value, before] : undamped) *value = before;
}

template <int dim, class Basis>
void ExplicitStep<dim, Basis>::compute_velocity_and_acceleration() {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  const transfer::VelocityAcceleration<dim> rates(m_rates);
  m_parts.grid.for_each_active_run([&](int I, int count) {
    const double* const inverse_mass = m_inverse_mass.data() + I;
    for (int d = 0; d < dim; ++d) {
      multiply(sums.momentum[d] + I, inverse_mass, count, rates.velocity[d] + I);
      multiply(sums.force[d] + I, inverse_mass, count, rates.acceleration[d] + I);
    }
  });
  m_parts.walls.unfold(m_parts.grid, m_rates);
}

/// Walls and rigid bodies act on the momentum of Eq. 9 as well, which becomes a velocity.
template <int dim, class Basis>
void ExplicitStep<dim, Basis>::constrain_remapped_momentum() {
  const transfer::MassMomentumForce<dim> sums(m_sums);
  const transfer::NodalVector<dim> remapped(m_remapped);
  m_parts.walls.fold(m_parts.grid, m_remapped);
  constrain({sums.mass, remapped.value});
  m_parts.walls.hold(m_parts.grid, m_remapped);
  m_parts.grid.for_each_active_run([&](int I, int count) {
    for (int d = 0; d < dim; ++d) scale(m_inverse_mass.data() + I, count, remapped.value[d] + I);
  });
  m_parts.walls.unfold(m_parts.grid, m_remapped);
}

namespace {

/// A particle whose stress is not finite, or -1.
template <int dim>
int find_broken_stress(const particles::ParticleView<dim>& view, const particles::Range& range) {
  int broken = -1;
  simd::for_each_group(range.size(), [&](int offset, int n) {
    const int first = range.first + offset;
    simd::Pack sum{};
    for (int c = 0; c < tensor_components<dim>; ++c) sum += simd::load(view.stress[c] + first, n);
    const simd::Mask finite = sum - sum == 0.0;
    if (simd::all(finite)) return;
    for (int lane = 0; lane < n; ++lane)
      if (!finite[lane]) broken = first + lane;
  });
  return broken;
}

}  // namespace

/// Turns the stresses that the increments cover with their particles and calls the laws, each on
/// its own particles. Returns one whose stress is not finite, or -1.
template <int dim, class Basis>
int ExplicitStep<dim, Basis>::update_stress(const View& view) {
  const petsc::Phase phase("mpm: stress");
  transfer::rotate_and_expand(view, m_increments);
  const particles::Range& range = m_increments.range;
  for (std::size_t k = 0; k < m_parts.particles.materials().size(); ++k) {
    const auto material = static_cast<int>(k);
    const auto part = intersection(range, m_parts.particles.range_of(material));
    if (part.size() == 0) continue;
    material::Batch batch = m_parts.particles.batch_of(view, material, part);
    for (std::size_t c = 0; c < m_increments.strain.size(); ++c)
      if (!m_increments.strain[c].empty())
        batch.strain_increment.component[c] =
            m_increments.strain[c].data() + (part.first - range.first);
    m_parts.particles.materials()[k]->update_stress(batch);
  }
  return find_broken_stress<dim>(view, range);
}

#define MPM_INSTANTIATE(dim, Basis) template class ExplicitStep<dim, Basis>;
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::solver
