#include "mpm/run/InitialStress.hpp"

#include <fmt/format.h>

#include <string>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::run {
namespace {

/// What a law says against the stresses of its particles; empty if nothing.
template <int dim>
std::string refusal(const particles::Particles<dim>& particles,
                    const particles::ParticleView<dim>& view) {
  try {
    for (std::size_t k = 0; k < particles.materials().size(); ++k)
      particles.materials()[k]->initialise_from_stress(
          particles.batch_of(view, static_cast<int>(k)));
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

}  // namespace

template <int dim>
void prescribe_stress(solver::Simulation<dim>& simulation,
                      const std::function<SymmetricTensor(const Vector<dim>&)>& stress_at) {
  std::string refused;
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const SymmetricTensor stress = stress_at(view.position_of(p));
      for (int k = 0; k < tensor_components<dim>; ++k) view.stress[k][p] = stress[k];
    }
    refused = refusal(simulation.particles(), view);
  }
  if (simulation.communicator().maximum(refused.empty() ? 0.0 : 1.0) > 0.0)
    throw BadInput(fmt::format("the soil cannot bear its initial stress{}{}",
                               refused.empty() ? "" : ": ", refused));
}

template void prescribe_stress<1>(solver::Simulation<1>&,
                                  const std::function<SymmetricTensor(const Vector<1>&)>&);
template void prescribe_stress<2>(solver::Simulation<2>&,
                                  const std::function<SymmetricTensor(const Vector<2>&)>&);
template void prescribe_stress<3>(solver::Simulation<3>&,
                                  const std::function<SymmetricTensor(const Vector<3>&)>&);

}  // namespace mpm::run
