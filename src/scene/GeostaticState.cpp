#include "mpm/scene/GeostaticState.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::scene {

void prescribe_stress(solver::Simulation<2>& simulation, const GeostaticStress& stress) {
  std::string refused;
  double deepest = 0.0;
  {
    auto& particles = simulation.particles();
    const auto view = particles.view();
    for (int p = 0; p < view.count; ++p) {
      const double vertical = stress.unit_weight * view.position[1][p];  // tension positive
      deepest = std::max(deepest, -view.position[1][p]);
      view.stress[0][p] = view.stress[2][p] = stress.K0 * vertical;
      view.stress[1][p] = vertical;
      view.stress[3][p] = 0.0;
    }
    try {
      for (std::size_t k = 0; k < particles.materials().size(); ++k)
        particles.materials()[k]->initialise_from_stress(
            particles.batch_of(view, static_cast<int>(k)));
    } catch (const BadInput& error) {
      refused = error.what();
    }
  }
  if (petsc::maximum(refused.empty() ? 0.0 : 1.0) > 0.0)
    throw BadInput(
        fmt::format("-geostatic_K0 {} is more than the soil can bear somewhere down to a depth of "
                    "{:.3g} m{}{}; "
                    "take a value nearer to 1 or more -sand_cohesion",
                    stress.K0, petsc::maximum(deepest), refused.empty() ? "" : ": ", refused));
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

}  // namespace mpm::scene
