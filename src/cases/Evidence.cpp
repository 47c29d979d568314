#include "mpm/cases/Evidence.hpp"

#include <cmath>

#include "mpm/petsc/Session.hpp"

namespace mpm::cases {

template <int dim>
double particles_at_limits(const particles::Particles<dim>& particles) {
  const auto view = particles.view();
  std::size_t count = 0;
  for (std::size_t k = 0; k < particles.materials().size(); ++k)
    count +=
        particles.materials()[k]->count_at_limits(particles.batch_of(view, static_cast<int>(k)));
  return petsc::sum(static_cast<double>(count));
}

run::Check limits_of_law() {
  return {.name = "limits_of_law",
          .limits = {0.05, 0.2},
          .sentence = "share of the particles at the law's pressure floor or cap",
          .remedy = "these have no strength of their own: see -sand_pressure_floor, -sand_psi_cap"};
}

template <int dim>
double particles_inside(const particles::Particles<dim>& particles,
                        const contact::RigidBody<dim>& body, double depth) {
  const auto view = particles.view();
  int count = 0;
  for (int p = 0; p < view.count; ++p)
    if (body.locate(view.position_of(p)).distance < -depth) ++count;
  return petsc::sum(static_cast<double>(count));
}

template <int dim>
double energy_residual_share(const solver::LedgerReport<dim>& ledger) {
  return std::abs(ledger.kinetic_residual) / std::abs(ledger.work_of_bodies.value_or(0.0));
}

#define MPM_INSTANTIATE(dim)                                                \
  template double particles_at_limits(const particles::Particles<dim>&);    \
  template double particles_inside(const particles::Particles<dim>&,        \
                                   const contact::RigidBody<dim>&, double); \
  template double energy_residual_share(const solver::LedgerReport<dim>&);
MPM_INSTANTIATE(1)
MPM_INSTANTIATE(2)
MPM_INSTANTIATE(3)
#undef MPM_INSTANTIATE

}  // namespace mpm::cases
