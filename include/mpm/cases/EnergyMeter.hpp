#pragma once

#include <memory>

#include "mpm/material/LinearElastic.hpp"
#include "mpm/run/Observer.hpp"

namespace mpm::cases {

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
  return simulation.communicator().sum(energy);
}

/// Energies of linear elastic bodies over time. Stress lives at the ends of steps and velocity at
/// their middles, so the kinetic energy at the end of a step is known only one step later.
template <int dim>
class EnergyMeter : public run::Observer<dim> {
 public:
  explicit EnergyMeter(std::shared_ptr<const material::LinearElastic> law)
      : m_law(std::move(law)) {}

  /// Measures the start, where velocity and stress belong to one time.
  void begin(const run::Moment<dim>& moment) override { start = m_last = now = at(moment); }

  void after_step(const run::Moment<dim>& moment) override {
    const Energies before = m_last;
    m_last = at(moment);
    now = start;
    if (before.time != start.time)
      now = {before.time, 0.5 * (before.kinetic + m_last.kinetic), before.strain};
  }

  void persist(Archive& archive) override {
    persist(archive, "start", start);
    persist(archive, "last", m_last);
    persist(archive, "now", now);
  }

  Energies start;
  /// Where the last step began, the kinetic energy as the mean of half a step before and half a
  /// step after.
  Energies now;

 private:
  Energies at(const run::Moment<dim>& moment) const {
    return {moment.clock.time, moment.simulation.kinetic_energy(),
            strain_energy(moment.simulation, *m_law)};
  }

  static void persist(Archive& archive, const char* name, Energies& energies) {
    archive.group(name, [&] {
      archive("time", energies.time);
      archive("kinetic", energies.kinetic);
      archive("strain", energies.strain);
    });
  }

  std::shared_ptr<const material::LinearElastic> m_law;
  Energies m_last;
};

}  // namespace mpm::cases
