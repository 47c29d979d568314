#pragma once

#include <functional>

#include "mpm/solver/Simulation.hpp"

namespace mpm::run {

/// Gives every particle the stress at its position, tension positive in Pa, and its law the state
/// that belongs to it. Throws BadInput on all ranks, with the law's own words where this rank has
/// them, if a law admits no such stress. Collective.
template <int dim>
void prescribe_stress(solver::Simulation<dim>& simulation,
                      const std::function<SymmetricTensor(const Vector<dim>&)>& stress_at);

}  // namespace mpm::run
