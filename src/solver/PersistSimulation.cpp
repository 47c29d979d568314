#include <fmt/format.h>

#include "mpm/solver/Simulation.hpp"

namespace mpm::solver {

template <int dim>
void Simulation<dim>::persist_constraints(Archive& archive) {
  for (std::size_t k = 0; k < m_constraints.size(); ++k)
    archive.group(fmt::format("{}", k), [&] { m_constraints[k]->persist(archive); });
}

/// Which cells may hold particles and when these are sorted belongs to their order on a rank.
template <int dim>
void Simulation<dim>::persist(Archive& archive) {
  archive("stable_dt", m_stable_dt);
  archive("first_dt", m_first_dt);
  archive("dt_old", m_dt_old);
  archive("steps", m_steps);
  archive("steps_since_renewal", m_steps_since_renewal);
  archive("rebalancings", m_rebalancings);
  archive("damping", m_options.damping);
  archive("gravity", m_options.body_force.uniform);
  archive.own("steps_since_sort", m_steps_since_sort);
  grid::Box<dim> active = m_grid->active_box();
  archive.own("active_begin", active.begin);
  archive.own("active_end", active.end);
  if (archive.gives()) m_grid->set_active_cells(active);
  archive.group("ledger", [&] { persist_ledger(archive); });
  archive.group("regularisation", [&] { persist_regularisation(archive); });
  archive.group("constraints", [&] { persist_constraints(archive); });
}

template <int dim>
void Simulation<dim>::keep_layout(const partition::Ownership<dim>& ownership) {
  if (ownership != m_grid->ownership()) m_grid->set_ownership(ownership);
  m_particles->keep_order();
}

template <int dim>
void Simulation<dim>::share_out() {
  if (communicator().size() > 1)
    m_grid->set_ownership(m_balance.ownership(m_particles->count_in_cells(), m_grid->ownership()));
  migrate();
}

#define MPM_INSTANTIATE(dim)                                                    \
  template void Simulation<dim>::persist_constraints(Archive&);                 \
  template void Simulation<dim>::persist(Archive&);                             \
  template void Simulation<dim>::keep_layout(const partition::Ownership<dim>&); \
  template void Simulation<dim>::share_out()
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::solver
