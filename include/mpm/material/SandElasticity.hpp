#pragma once

#include <cmath>

#include "mpm/core/Series.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// Pressure-dependent elasticity of the sand law. Pressures p* = p + p_c, Pa, and volumetric
/// strains are compression positive. `Real` is double or simd::Pack.
class SandElasticity {
 public:
  explicit SandElasticity(const SandParameters& sand);

  /// G of Eq. 15, Pa, from the square root of p*.
  template <class Real>
  Real shear_modulus_of_root(Real root_p_star) const {
    return m_G_of_root * root_p_star;
  }
  template <class Real>
  Real shear_modulus(Real p_star) const {
    return m_G_of_root * simd::sqrt(p_star);
  }

  /// K/p* with K = (1 + e0) p*/kappa, or Eq. 24 in the power form.
  template <class Real>
  Real stiffness(Real p_star) const {
    if (!m_power_form) return simd::splat<Real>(m_stiffness);
    return m_power_stiffness / m_xi * simd::pow(p_star, -m_xi);
  }
  /// K, Pa.
  template <class Real>
  Real bulk_modulus(Real p_star) const {
    return stiffness(p_star) * p_star;
  }

  /// The end of an elastic path on which strain grows in proportion.
  template <class Real>
  struct PathEndOf {
    Real p_star;
    Real mean_shear_modulus;  ///< over the path, so that ds = 2 mean(G) de exactly
  };
  using PathEnd = PathEndOf<double>;

  /// Integrated in closed form: a closed elastic loop returns to its start.
  PathEnd follow(double p_star, double volumetric_strain) const {
    if (m_power_form) return follow_power(p_star, volumetric_strain);
    const double half = 0.5 * m_stiffness * volumetric_strain;
    const double ratio = std::abs(half) > 1e-8 ? std::expm1(half) / half : 1.0 + 0.5 * half;
    return grown(p_star, shear_modulus(p_star), half, ratio);
  }

  /// The same from G at the start, for |K volumetric_strain| <= p* simd::small_limit.
  template <class Real>
  PathEndOf<Real> follow_little(Real p_star, Real G, Real volumetric_strain) const {
    if (m_power_form) return follow_power(p_star, volumetric_strain);
    const Real half = 0.5 * m_stiffness * volumetric_strain;
    return grown(p_star, G, half, simd::small_expm1_ratio(half));
  }

  /// Elastic volumetric strain (negative) that lowers p* to the floor.
  double strain_to_pressure(double p_star, double floor) const {
    if (!m_power_form) return std::log(floor / p_star) / m_stiffness;
    return (std::pow(floor, m_xi) - std::pow(p_star, m_xi)) / m_power_stiffness;
  }

 private:
  /// Half of the growth of ln p* and (exp(half) - 1)/half: sqrt(p*) grows to exp(half) of itself.
  template <class Real>
  PathEndOf<Real> grown(Real p_star, Real G, Real half, Real ratio) const {
    const Real growth = 1.0 + half * ratio;
    return {p_star * growth * growth, G * ratio};
  }

  /// Eq. 24 makes y = p*^xi linear in strain; G grows like y^n.
  template <class Real>
  PathEndOf<Real> follow_power(Real p_star, Real volumetric_strain) const {
    const double n = 0.5 / m_xi;
    const Real root0 = simd::sqrt(p_star);
    const Real y0 = simd::pow(p_star, m_xi);
    const Real change = m_power_stiffness * volumetric_strain;
    const Real y1 = simd::max(y0 + change, Real{});  // 0: down to no pressure
    const Real root1 = simd::select(y1 <= 0.0, Real{}, simd::pow(y1, n));
    const auto little = simd::abs(change) < 1e-3 * y0;
    const Real simpson = (root0 + 4.0 * simd::pow(y0 + 0.5 * change, n) + root1) / 6.0;
    const Real integral =
        (y1 * root1 - y0 * root0) / ((n + 1.0) * simd::select(little, y0, change));
    return {root1 * root1,
            m_G_of_root * simd::select(y1 <= 0.0, Real{}, simd::select(little, simpson, integral))};
  }

  double m_G_of_root;
  double m_stiffness;
  bool m_power_form;
  double m_xi = 1.0;
  double m_power_stiffness = 0.0;
};

}  // namespace mpm::material
