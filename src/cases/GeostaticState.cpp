#include "mpm/cases/GeostaticState.hpp"

#include <cmath>

#include "mpm/petsc/Session.hpp"

namespace mpm::cases {

std::function<SymmetricTensor(const Vector<2>&)> vertical_and_lateral(
    const GeostaticStress& stress) {
  return [stress](const Vector<2>& x) {
    const double vertical = stress.unit_weight * x[1];
    return SymmetricTensor{{stress.K0 * vertical, vertical, stress.K0 * vertical, 0.0, 0.0, 0.0}};
  };
}

GeostaticErrors measure_geostatic(const solver::Simulation<2>& simulation,
                                  const GeostaticStress& stress,
                                  const std::function<bool(const Vector<2>&)>& counts) {
  const auto view = simulation.particles().view();
  double vertical = 0.0, ratio = 0.0, reference = 0.0;
  for (int p = 0; p < view.count; ++p) {
    if (!counts(view.position_of(p))) continue;
    const double exact = stress.unit_weight * view.position[1][p];
    vertical += std::pow(view.stress[1][p] - exact, 2);
    ratio += std::pow(view.stress[0][p] - stress.K0 * view.stress[1][p], 2);
    reference += exact * exact;
  }
  reference = petsc::sum(reference);
  if (reference == 0.0) return {0.0, 0.0};
  return {std::sqrt(petsc::sum(vertical) / reference), std::sqrt(petsc::sum(ratio) / reference)};
}

}  // namespace mpm::cases
