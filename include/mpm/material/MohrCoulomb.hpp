#pragma once

#include <array>

#include "mpm/material/LinearElastic.hpp"

namespace mpm::material {

struct MohrCoulombParameters {
  LinearElasticParameters elastic{.youngs_modulus = 10e6, .poisson_ratio = 0.3, .density = 1700.0};
  double friction_angle = 35.0;  ///< phi, degrees; 0 makes the solid Tresca's
  double dilation_angle = 5.0;   ///< psi, degrees
  double cohesion = 0.0;         ///< c, Pa
};

/// Linear elastic, perfectly plastic solid of Mohr and Coulomb. With the principal stresses
/// sigma_1 >= sigma_2 >= sigma_3 (tension positive) and N(x) = (1 + sin x)/(1 - sin x) the yield
/// function is f = N(phi) sigma_1 - sigma_3 - 2 c sqrt(N(phi)), and the plastic potential the same
/// with the dilation angle psi. The return to planes, edges and apex is closed-form in principal
/// stresses, without rounding (Clausen, Damkilde & Andersen 2006, 2007). No tension beyond the
/// apex, c cot(phi), where an opening is not remembered.
class MohrCoulomb : public Material {
 public:
  using PrincipalStress = std::array<double, 3>;  ///< Pa, largest first

  /// Throws BadInput unless 0 <= psi <= phi < 90 degrees, c >= 0 and not both phi and c are 0, and
  /// where the elastic constants make no sense.
  explicit MohrCoulomb(const MohrCoulombParameters& parameters);

  std::string_view name() const override { return "mohr_coulomb"; }
  std::span<const StateVariable> state_variables() const override;
  double initial_density() const override { return m_elastic.initial_density(); }
  void update_stress(const Batch& batch) const override;
  void wave_modulus(const Batch& batch, std::span<double> modulus) const override;
  /// No plastic strain yet. Throws BadInput where the stress violates the yield condition.
  void initialise_from_stress(const Batch& batch) const override;
  bool has_strain_energy() const override { return true; }
  /// Of the elastic part, see LinearElastic.
  void strain_energy_density(const Batch& batch, std::span<double> density) const override {
    m_elastic.strain_energy_density(batch, density);
  }
  /// Particles at the apex, whose further expansion meets no stress.
  std::size_t count_at_limits(const Batch& batch) const override;

  /// f, Pa, negative inside.
  double yield_function(const PrincipalStress& stress) const {
    return m_N * stress[0] - stress[2] - m_compressive_strength;
  }
  /// The stress to which plastic flow takes a trial stress of f > 0.
  PrincipalStress return_to_surface(const PrincipalStress& trial) const;

 private:
  enum class Edge { compression, extension };

  PrincipalStress return_to_plane(const PrincipalStress& trial) const;
  PrincipalStress return_to_edge(const PrincipalStress& trial, Edge edge) const;
  double stiffness_against_own_flow() const;

  MohrCoulombParameters m_parameters;
  LinearElastic m_elastic;
  double m_N;                     ///< N(phi)
  double m_N_dilation;            ///< N(psi)
  double m_compressive_strength;  ///< 2 c sqrt(N(phi)), Pa
  double m_apex;                  ///< largest isotropic tension, Pa; infinite without friction
};

/// The -mohr_coulomb_* options.
class MohrCoulombFactory : public MaterialFactory {
 public:
  void declare(options::OptionSet& set) override;
  std::unique_ptr<Material> create() const override;

  /// A scene may change defaults before declare().
  MohrCoulombParameters& parameters() { return m_parameters; }

 private:
  MohrCoulombParameters m_parameters;
};

}  // namespace mpm::material
