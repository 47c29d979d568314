#pragma once

#include "mpm/material/LinearElastic.hpp"

namespace mpm::material {

struct VonMisesParameters {
  LinearElasticParameters elastic{.youngs_modulus = 5e6, .poisson_ratio = 0.49, .density = 1800.0};
  double shear_strength = 10e3;  ///< c, Pa, in simple shear
};

/// Linear elastic, perfectly plastic solid with the yield function of von Mises,
/// f = q - sigma_y with sigma_y = sqrt(3) c, and associated flow. c is the strength in simple
/// shear; plane strain without plastic change of volume shears simply, so there
/// sigma_1 - sigma_3 = 2 c, as for Tresca, and Prandtl's footing carries (2 + pi) c. In triaxial
/// tests q = sqrt(3) c, where Tresca's is 2 c. Integrated by radial return, the closest point in
/// energy (Wilkins 1964; Krieg & Krieg 1977): exact while the strain rate keeps to the direction
/// of the stress deviator, of first order in the increment where it does not.
class VonMises : public Material {
 public:
  /// Throws BadInput unless c > 0, and where the elastic constants make no sense.
  explicit VonMises(const VonMisesParameters& parameters);

  std::string_view name() const override { return "von_mises"; }
  std::span<const StateVariable> state_variables() const override;
  double initial_density() const override { return m_elastic.initial_density(); }
  void update_stress(const Batch& batch) const override;
  void wave_modulus(const Batch& batch, std::span<double> modulus) const override;
  /// No plastic strain yet. Throws BadInput where q exceeds sqrt(3) c.
  void initialise_from_stress(const Batch& batch) const override;
  bool has_strain_energy() const override { return true; }
  /// Of the elastic part, see LinearElastic.
  void strain_energy_density(const Batch& batch, std::span<double> density) const override {
    m_elastic.strain_energy_density(batch, density);
  }

 private:
  LinearElastic m_elastic;
  double m_shear_strength;  ///< Pa
  double m_yield_stress;    ///< Pa, largest q
};

/// The -von_mises_* options.
class VonMisesFactory : public MaterialFactory {
 public:
  void declare(options::OptionSet& set) override;
  std::unique_ptr<Material> create() const override;

  /// A scene may change defaults before declare().
  VonMisesParameters& parameters() { return m_parameters; }

 private:
  VonMisesParameters m_parameters;
};

}  // namespace mpm::material
