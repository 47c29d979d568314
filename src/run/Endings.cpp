#include "mpm/run/Endings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/core/Errors.hpp"

namespace mpm::run {

template <int dim>
double unbalanced_share(const solver::Simulation<dim>& simulation, double reference_force) {
  const double share = reference_force == 0.0 ? simulation.out_of_balance()
                                              : simulation.unbalanced_force() / reference_force;
  return std::min(1.0, share);
}

template <int dim>
void AtRest<dim>::after_step(const Moment<dim>& moment) {
  const long long steps = moment.clock.steps_in_stage;
  if (steps % m_options.check_every != 0) return;
  m_unbalanced = unbalanced_share(moment.simulation, m_options.reference_force);
  if (m_options.at_check) m_options.at_check(moment);
  if (steps >= m_options.longest)
    throw NumericalFailure(
        fmt::format("no rest, out of balance {:.3g} after {} steps where {:.3g} is asked for; a "
                    "larger tolerance or another damping may help",
                    m_unbalanced, steps, m_options.tolerance),
        failure_kind("no_rest", "a larger tolerance or another damping"));
}

template <int dim>
double AtRest<dim>::share_done(const Moment<dim>&) const {
  return std::log(m_unbalanced) / std::log(m_options.tolerance);
}

template <int dim>
std::string AtRest<dim>::status() const {
  return fmt::format("out of balance {:.2e}", m_unbalanced);
}

#define MPM_INSTANTIATE(dim)  \
  template class AtRest<dim>; \
  template double unbalanced_share(const solver::Simulation<dim>&, double);
MPM_INSTANTIATE(1)
MPM_INSTANTIATE(2)
MPM_INSTANTIATE(3)
#undef MPM_INSTANTIATE

}  // namespace mpm::run
