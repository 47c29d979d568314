#pragma once

#include "mpm/contact/RigidBody.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/run/Checks.hpp"
#include "mpm/solver/Ledger.hpp"

namespace mpm::cases {

/// Particles of all ranks at their law's pressure floor, apex or cap of the state parameter.
/// Collective.
template <int dim>
double particles_at_limits(const particles::Particles<dim>& particles);

/// The check of their share, -check_limits_of_law.
run::Check limits_of_law();

/// Particles of all ranks deeper in a body than that, m. Collective.
template <int dim>
double particles_inside(const particles::Particles<dim>& particles,
                        const contact::RigidBody<dim>& body, double depth);

/// What transfers between particles and grid have lost, as a share of the work of the bodies.
template <int dim>
double energy_residual_share(const solver::LedgerReport<dim>& ledger);

}  // namespace mpm::cases
