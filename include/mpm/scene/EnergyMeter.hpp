#pragma once

#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::scene {

/// Of all particles at one time, J (per metre in plane strain).
struct Energies {
  double time = 0.0;  ///< s
  double kinetic = 0.0;
  double strain = 0.0;

  double total() const { return kinetic + strain; }
};

/// Sum of V sigma : epsilon/2 over the particles of a linear elastic body. Collective.
template <int dim>
double strain_energy(const solver::Simulation<dim>& simulation,
                     const material::LinearElastic& law) {
  const auto view = simulation.particles().view();
  double energy = 0.0;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor stress;
    for (int k = 0; k < tensor_components<dim>; ++k) stress[k] = view.stress[k][p];
    energy += view.volume[p] * law.strain_energy_density(stress);
  }
  return petsc::sum(energy);
}

/// Energies of linear elastic bodies over time. Stress lives at the ends of steps and velocity at
/// their middles, so the kinetic energy at the end of a step is known only one step later.
template <int dim>
class EnergyMeter {
 public:
  /// Measures the start at time 0, where velocity and stress belong to one time. Collective; both
  /// must outlive the meter.
  EnergyMeter(const solver::Simulation<dim>& simulation, const material::LinearElastic& law)
      : m_simulation(simulation), m_law(law), m_start(at(0.0)), m_last(m_start) {}

  const Energies& start() const { return m_start; }

  /// To be called after every step, which ends at `time`: the energies where that step began, the
  /// kinetic one as the mean of half a step before and half a step after. Collective.
  Energies after_step(double time) {
    const Energies before = m_last;
    m_last = at(time);
    if (before.time == m_start.time) return m_start;
    return {before.time, 0.5 * (before.kinetic + m_last.kinetic), before.strain};
  }

 private:
  Energies at(double time) const {
    return {time, m_simulation.kinetic_energy(), strain_energy(m_simulation, m_law)};
  }

  const solver::Simulation<dim>& m_simulation;
  const material::LinearElastic& m_law;
  Energies m_start, m_last;
};

}  // namespace mpm::scene
