#pragma once

#include <cmath>

#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// Pressure-dependent elasticity of the sand law. Pressures p* = p + p_c, Pa, and volumetric
/// strains are compression positive.
class SandElasticity {
 public:
  explicit SandElasticity(const SandParameters& sand);

  /// G of Eq. 15, Pa, from the square root of p*.
  double shear_modulus_of_root(double root_p_star) const { return m_G_of_root * root_p_star; }
  double shear_modulus(double p_star) const { return m_G_of_root * std::sqrt(p_star); }

  /// K = (1 + e0) p*/kappa, or Eq. 24 in the power form, Pa.
  double bulk_modulus(double p_star) const {
    if (!m_power_form) return m_stiffness * p_star;
    return m_power_stiffness / m_xi * std::pow(p_star, 1.0 - m_xi);
  }

  /// The end of an elastic path on which strain grows in proportion.
  struct PathEnd {
    double p_star;
    double mean_shear_modulus;  ///< over the path, so that ds = 2 mean(G) de exactly
  };
  /// Integrated in closed form: a closed elastic loop returns to its start.
  PathEnd follow(double p_star, double volumetric_strain) const {
    return m_power_form ? follow_power(p_star, volumetric_strain)
                        : follow_exponential(p_star, volumetric_strain);
  }

  /// Elastic volumetric strain (negative) that lowers p* to the floor.
  double strain_to_pressure(double p_star, double floor) const {
    if (!m_power_form) return std::log(floor / p_star) / m_stiffness;
    return (std::pow(floor, m_xi) - std::pow(p_star, m_xi)) / m_power_stiffness;
  }

 private:
  PathEnd follow_exponential(double p_star, double volumetric_strain) const {
    const double half = 0.5 * m_stiffness * volumetric_strain;
    const double growth = std::expm1(half);
    const double mean = std::abs(half) > 1e-8 ? growth / half : 1.0 + 0.5 * half;
    return {p_star * (1.0 + growth) * (1.0 + growth), shear_modulus(p_star) * mean};
  }
  PathEnd follow_power(double p_star, double volumetric_strain) const;

  double m_G_of_root;
  double m_stiffness;
  bool m_power_form;
  double m_xi = 1.0;
  double m_power_stiffness = 0.0;
};

}  // namespace mpm::material
