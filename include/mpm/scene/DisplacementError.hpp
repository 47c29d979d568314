#pragma once

#include <cmath>

#include "mpm/petsc/Session.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::scene {

/// Root mean square over all particles of |u - exact(X)|, m, with X the undeformed position.
/// Collective.
template <int dim, class Exact>
double rms_displacement_error(const solver::Simulation<dim>& simulation, const Exact& exact) {
  const auto view = simulation.particles().view();
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) {
    Vector<dim> X;
    for (int d = 0; d < dim; ++d) X[d] = view.position[d][p] - view.displacement[d][p];
    const Vector<dim> u = exact(X);
    for (int d = 0; d < dim; ++d) {
      const double error = view.displacement[d][p] - u[d];
      sum += error * error;
    }
  }
  const auto count = static_cast<double>(simulation.particles().global_count());
  return std::sqrt(petsc::sum(sum) / count);
}

}  // namespace mpm::scene
