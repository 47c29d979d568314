#pragma once

#include <array>
#include <random>

#include "mpm/material/SandLaw.hpp"

namespace mpm::material {

inline SandParameters sand_with(double void_ratio, double cohesion) {
  SandParameters sand;
  sand.void_ratio = void_ratio;
  sand.cohesion = cohesion;
  return sand;
}

/// One particle driven by strain increments.
class Particle {
 public:
  explicit Particle(const SandLaw& law, SymmetricTensor initial_stress)
      : m_law(law), stress(initial_stress) {
    law.initialise_from_stress(batch());
  }
  Batch batch() {
    Batch one;
    one.size = 1;
    for (std::size_t k = 0; k < 6; ++k) {
      one.strain_increment.component[k] = &m_strain.components[k];
      one.stress.component[k] = &stress.components[k];
    }
    for (double& value : state) one.state.push_back(&value);
    return one;
  }
  void strain_by(const SymmetricTensor& increment) {
    m_strain = increment;
    m_law.update_stress(batch());
  }
  void strain_by(const SymmetricTensor& increment, int parts) {
    for (int k = 0; k < parts; ++k) strain_by((1.0 / parts) * increment);
  }
  SurfaceState surface_state() const {
    const SandInvariants now = m_law.invariants(stress);
    return {now.p_star, void_ratio(), eps_q(), now.sin3theta};
  }
  double q() const { return m_law.invariants(stress).q; }
  double p_star() const { return m_law.invariants(stress).p_star; }
  double qhat() const { return m_law.surface().at(surface_state()).qhat; }
  double void_ratio() const { return state[SandLaw::void_ratio]; }
  double eps_q() const { return state[SandLaw::eps_q]; }
  double gap() const { return state[SandLaw::gap_volume_ratio]; }

 private:
  const SandLaw& m_law;
  SymmetricTensor m_strain;

 public:
  SymmetricTensor stress;
  std::array<double, 3> state{};
};

inline SymmetricTensor principal(double xx, double yy, double zz) {
  return {{xx, yy, zz, 0, 0, 0}};
}
inline SymmetricTensor isotropic(double pressure) {
  return principal(-pressure, -pressure, -pressure);
}
inline SymmetricTensor at_rest(double vertical, double K0) {
  return principal(-K0 * vertical, -vertical, -K0 * vertical);
}

inline SymmetricTensor random_strain(std::mt19937& generator, double size) {
  std::normal_distribution<double> normal;
  SymmetricTensor strain;
  for (int k = 0; k < 6; ++k) strain[k] = size * normal(generator);
  return strain;
}

}  // namespace mpm::material
