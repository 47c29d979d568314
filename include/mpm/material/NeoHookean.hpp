#pragma once

#include "mpm/material/Material.hpp"

namespace mpm::material {

struct NeoHookeanParameters {
  double youngs_modulus = 1e4;  ///< Pa, at small strain
  double poisson_ratio = 0.0;
  double density = 1.0;  ///< kg/m^3
};

/// Compressible neo-Hookean solid, sigma = [mu (b - 1) + lambda ln J 1]/J, for exact solutions.
/// Keeps J as state; the left Cauchy-Green tensor b follows from stress and J, so that it turns
/// with the stress, and grows by b <- exp(D dt) b exp(D dt).
class NeoHookean : public Material {
 public:
  /// Throws BadInput on values without sense.
  explicit NeoHookean(const NeoHookeanParameters& parameters);

  std::string_view name() const override { return "neo_hookean"; }
  std::span<const StateVariable> state_variables() const override;
  double initial_density() const override { return m_parameters.density; }
  void update_stress(const Batch& batch) const override;
  void wave_modulus(const Batch& batch, std::span<double> modulus) const override;
  /// Not meant for prescribed stresses: throws BadInput.
  void initialise_from_stress(const Batch& batch) const override;
  bool has_strain_energy() const override { return true; }
  /// [mu (tr b - 3)/2 - mu ln J + lambda (ln J)^2/2]/J.
  void strain_energy_density(const Batch& batch, std::span<double> density) const override;

 private:
  NeoHookeanParameters m_parameters;
  double m_lambda, m_mu;
};

}  // namespace mpm::material
