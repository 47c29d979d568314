#include "mpm/solver/Ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace mpm::solver {
namespace {

template <int dim>
double size_of(const Vector<dim>& a) {
  double square = 0.0;
  for (double component : a) square += component * component;
  return std::sqrt(square);
}

/// Values of a rank that become sums over the ranks in one message.
class Parcel {
 public:
  void add(double& value) { m_values.push_back(&value); }
  template <std::size_t size>
  void add(std::array<double, size>& values) {
    for (double& value : values) add(value);
  }
  /// Collective.
  void sum(const petsc::Communicator& ranks) const {
    std::vector<double> sums;
    for (const double* value : m_values) sums.push_back(*value);
    ranks.sum(sums);
    for (std::size_t k = 0; k < sums.size(); ++k) *m_values[k] = sums[k];
  }

 private:
  std::vector<double*> m_values;
};

template <int dim>
void add(ParticleSums<dim>& particles, Parcel& parcel) {
  parcel.add(particles.momentum);
  parcel.add(particles.kinetic);
  parcel.add(particles.motion);
  if (particles.strain) parcel.add(*particles.strain);
}

template <int dim>
void add(Cause<dim>& cause, Parcel& parcel) {
  parcel.add(cause.impulse);
  parcel.add(cause.work);
  parcel.add(cause.body_work);
}

}  // namespace

std::string wall_cause(int wall) {
  constexpr std::array<const char*, 6> names{"wall_left", "wall_right", "wall_bottom",
                                             "wall_top",  "wall_front", "wall_back"};
  return names[static_cast<std::size_t>(wall)];
}

template <int dim>
Cause<dim>& Ledger<dim>::cause(const std::string& name) {
  const auto found = std::ranges::find(m_causes, name, &Cause<dim>::name);
  if (found != m_causes.end()) return *found;
  return m_causes.emplace_back(Cause<dim>{.name = name});
}

template <int dim>
void Ledger<dim>::open(const ParticleSums<dim>& start) {
  for (Cause<dim>& cause : m_causes) cause = {.name = cause.name, .is_body = cause.is_body};
  m_total_work = 0.0;
  m_start = start;
}

template <int dim>
void Ledger<dim>::persist(Archive& archive) {
  for (Cause<dim>& cause : m_causes)
    archive.group(cause.name, [&] {
      archive.sum("impulse", cause.impulse);
      archive.sum("work", cause.work);
      if (cause.is_body) archive.sum("body_work", cause.body_work);
    });
  archive.sum("total_work", m_total_work);
  archive("start_momentum", m_start.momentum);
  archive("start_kinetic", m_start.kinetic);
  archive("start_motion", m_start.motion);
  if (m_start.strain) archive("start_strain", *m_start.strain);
}

template <int dim>
ParticleSums<dim> summed(ParticleSums<dim> share, const petsc::Communicator& ranks) {
  Parcel parcel;
  add<dim>(share, parcel);
  parcel.sum(ranks);
  return share;
}

namespace {

/// Of what the causes have not done, momentum and energy.
template <int dim>
void take_off(const Cause<dim>& cause, LedgerReport<dim>& sums) {
  sums.internal_work -= cause.work;
  for (int d = 0; d < dim; ++d) sums.momentum_residual[d] -= cause.impulse[d];
  if (!cause.is_body) return;
  sums.work_of_bodies = sums.work_of_bodies.value_or(0.0) + cause.body_work;
  sums.friction_work = sums.friction_work.value_or(0.0) + (cause.work - cause.body_work);
}

}  // namespace

template <int dim>
LedgerReport<dim> report(const Ledger<dim>& ledger, ParticleSums<dim> now,
                         const petsc::Communicator& ranks) {
  LedgerReport<dim> sums{.causes = ledger.causes(), .internal_work = ledger.total_work()};
  Parcel parcel;
  parcel.add(sums.internal_work);
  add<dim>(now, parcel);
  for (Cause<dim>& cause : sums.causes) add<dim>(cause, parcel);
  parcel.sum(ranks);
  const ParticleSums<dim>& start = ledger.start();
  sums.kinetic_change = now.kinetic - start.kinetic;
  sums.kinetic_residual = sums.kinetic_change - sums.internal_work;
  for (int d = 0; d < dim; ++d) sums.momentum_residual[d] = now.momentum[d] - start.momentum[d];
  double scale = start.motion + now.motion;
  for (const Cause<dim>& cause : sums.causes) {
    take_off(cause, sums);
    scale += size_of<dim>(cause.impulse);
  }
  sums.momentum_residual_share = scale > 0.0 ? size_of<dim>(sums.momentum_residual) / scale : 0.0;
  if (!now.strain || !start.strain) return sums;
  sums.strain_change = *now.strain - *start.strain;
  sums.plastic_work = 0.0 - sums.internal_work - *sums.strain_change;
  sums.dissipation = *sums.plastic_work - sums.kinetic_residual;
  return sums;
}

template <int dim>
std::vector<std::pair<std::string, double>> entries(const LedgerReport<dim>& report) {
  std::vector<std::pair<std::string, double>> all;
  for (const Cause<dim>& cause : report.causes) {
    for (int d = 0; d < dim; ++d)
      all.emplace_back(fmt::format("impulse_{}_{}_N_s", cause.name, "xyz"[d]), cause.impulse[d]);
    all.emplace_back(fmt::format("work_{}_J", cause.name), cause.work);
  }
  const auto add_if = [&](const char* name, const std::optional<double>& value) {
    if (value) all.emplace_back(name, *value);
  };
  add_if("work_of_bodies_J", report.work_of_bodies);
  add_if("friction_work_J", report.friction_work);
  all.emplace_back("momentum_residual", report.momentum_residual_share);
  all.emplace_back("internal_work_J", report.internal_work);
  add_if("strain_energy_change_J", report.strain_change);
  add_if("plastic_work_J", report.plastic_work);
  add_if("dissipation_J", report.dissipation);
  all.emplace_back("kinetic_energy_change_J", report.kinetic_change);
  all.emplace_back("kinetic_energy_residual_J", report.kinetic_residual);
  return all;
}

#define MPM_INSTANTIATE(dim)                                                        \
  template class Ledger<dim>;                                                       \
  template ParticleSums<dim> summed(ParticleSums<dim>, const petsc::Communicator&); \
  template LedgerReport<dim> report(const Ledger<dim>&, ParticleSums<dim>,          \
                                    const petsc::Communicator&);                    \
  template std::vector<std::pair<std::string, double>> entries(const LedgerReport<dim>&);
MPM_INSTANTIATE(1)
MPM_INSTANTIATE(2)
MPM_INSTANTIATE(3)

}  // namespace mpm::solver
