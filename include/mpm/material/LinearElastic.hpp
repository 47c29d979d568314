#pragma once

#include <string>
#include <string_view>

#include "mpm/material/Material.hpp"
#include "mpm/material/PackTensor.hpp"

namespace mpm::material {

struct LinearElasticParameters {
  double youngs_modulus = 1e6;  ///< E, Pa
  double poisson_ratio = 0.3;   ///< nu
  double density = 2000.0;      ///< kg/m^3
};

/// Isotropic linear elasticity in rate form: dsigma = lambda tr(D dt) I + 2 mu D dt. Also the
/// elastic part of other laws.
class LinearElastic : public Material {
 public:
  /// Throws BadInput unless E > 0, density > 0 and -1 < nu < 0.5, naming the options
  /// -`prefix`_youngs_modulus and so on.
  explicit LinearElastic(const LinearElasticParameters& parameters,
                         std::string_view prefix = "elastic");

  std::string_view name() const override { return "elastic"; }
  std::span<const StateVariable> state_variables() const override { return {}; }
  double initial_density() const override { return m_density; }
  void update_stress(const Batch& batch) const override;
  void wave_modulus(const Batch& batch, std::span<double> modulus) const override;
  void initialise_from_stress(const Batch&) const override {}
  bool has_strain_energy() const override { return true; }
  /// p^2/2K + s:s/4G of the Cauchy stress. The rate form has a potential to first order in strain
  /// only: of a large strain the work and this differ by a share of the order of the strain.
  void strain_energy_density(const Batch& batch, std::span<double> density) const override;

  double lambda() const { return m_lambda; }     ///< Lame's first constant, Pa
  double shear_modulus() const { return m_mu; }  ///< Pa

  /// Pa, for a strain increment.
  SymmetricTensor stress_increment(const SymmetricTensor& strain) const {
    SymmetricTensor stress = 2.0 * m_mu * strain;
    const double isotropic = m_lambda * trace(strain);
    for (int k = 0; k < 3; ++k) stress[k] += isotropic;
    return stress;
  }

  /// The stress after an elastic increment of the particles of a batch from p on, `count` of which
  /// are left.
  PackTensor trial_stress(const Batch& batch, std::size_t p, std::size_t count) const {
    PackTensor stress = load_lanes(batch.stress, p, count);
    const PackTensor strain = load_lanes(batch.strain_increment, p, count);
    const simd::Pack isotropic = m_lambda * trace(strain);
    for (int k = 0; k < SymmetricTensor::size; ++k) stress[k] += 2.0 * m_mu * strain[k];
    for (int k = 0; k < 3; ++k) stress[k] += isotropic;
    return stress;
  }

  /// The small strain under which an unstressed particle has this stress.
  SymmetricTensor elastic_strain(const SymmetricTensor& stress) const {
    SymmetricTensor strain = (0.5 / m_mu) * stress;
    const double isotropic =
        m_lambda / (2.0 * m_mu * (3.0 * m_lambda + 2.0 * m_mu)) * trace(stress);
    for (int k = 0; k < 3; ++k) strain[k] -= isotropic;
    return strain;
  }

  /// sigma : epsilon/2, J/m^3; of first order in the strain.
  double strain_energy_density(const SymmetricTensor& stress) const {
    return 0.5 * contract(stress, elastic_strain(stress));
  }

 private:
  double m_lambda;  ///< Pa
  double m_mu;      ///< Pa
  double m_density;
};

/// Declares -`prefix`_youngs_modulus, -`prefix`_poisson_ratio and -`prefix`_density.
void declare_linear_elastic(options::OptionSet& set, const std::string& prefix,
                            LinearElasticParameters& parameters);

/// The -elastic_* options.
class LinearElasticFactory : public MaterialFactory {
 public:
  void declare(options::OptionSet& set) override;
  std::unique_ptr<Material> create() const override;

  /// A scene may change defaults before declare().
  LinearElasticParameters& parameters() { return m_parameters; }

 private:
  LinearElasticParameters m_parameters;
};

}  // namespace mpm::material
