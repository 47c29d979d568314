#include "mpm/solver/Ledger.hpp"

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
  for (Cause<dim>& cause : m_causes) cause = {.name = cause.name};
  m_total_work = 0.0;
  m_start = start;
}

template <int dim>
void Ledger<dim>::persist(Archive& archive) {
  for (Cause<dim>& cause : m_causes)
    archive.group(cause.name, [&] {
      archive("impulse", cause.impulse);
      archive("work", cause.work);
    });
  archive("total_work", m_total_work);
  archive("start_momentum", m_start.momentum);
  archive("start_kinetic", m_start.kinetic);
  archive("start_motion", m_start.motion);
}

template <int dim>
LedgerReport<dim> report(const Ledger<dim>& ledger, const ParticleSums<dim>& now,
                         const petsc::Communicator& ranks) {
  LedgerReport<dim> sums;
  sums.internal_work = ranks.sum(ledger.total_work());
  sums.kinetic_change = now.kinetic - ledger.start().kinetic;
  sums.kinetic_residual = sums.kinetic_change - sums.internal_work;
  double scale = ledger.start().motion + now.motion;
  for (int d = 0; d < dim; ++d)
    sums.momentum_residual[d] = now.momentum[d] - ledger.start().momentum[d];
  for (Cause<dim> cause : ledger.causes()) {
    for (double& component : cause.impulse) component = ranks.sum(component);
    cause.work = ranks.sum(cause.work);
    sums.internal_work -= cause.work;
    for (int d = 0; d < dim; ++d) sums.momentum_residual[d] -= cause.impulse[d];
    scale += size_of<dim>(cause.impulse);
    sums.causes.push_back(cause);
  }
  sums.momentum_residual_share = scale > 0.0 ? size_of<dim>(sums.momentum_residual) / scale : 0.0;
  return sums;
}

template class Ledger<1>;
template class Ledger<2>;
template class Ledger<3>;
template LedgerReport<1> report(const Ledger<1>&, const ParticleSums<1>&,
                                const petsc::Communicator&);
template LedgerReport<2> report(const Ledger<2>&, const ParticleSums<2>&,
                                const petsc::Communicator&);
template LedgerReport<3> report(const Ledger<3>&, const ParticleSums<3>&,
                                const petsc::Communicator&);

}  // namespace mpm::solver
