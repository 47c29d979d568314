#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "mpm/core/Series.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// Pressure-dependent elasticity of the sand law. Pressures p* = p + p_c, Pa, and volumetric
/// strains are compression positive. `Real` is double or simd::Pack.
///
/// Every reading of K has the form K/p* = k p*^-n: n = 0 (log), xi (power), 1/2 (poisson).
class SandElasticity {
 public:
  explicit SandElasticity(const SandConstants& sand, double void_ratio);

  /// G of Eq. 15, Pa, from the square root of p*.
  template <class Real>
  Real shear_modulus_of_root(Real root_p_star) const {
    return m_G_of_root * root_p_star;
  }
  template <class Real>
  Real shear_modulus(Real p_star) const {
    return m_G_of_root * simd::sqrt(p_star);
  }

  /// n above.
  double exponent() const { return m_n; }
  /// K/p*, 1.
  template <class Real>
  Real stiffness(Real p_star) const {
    if (m_n == 0.0) return simd::splat<Real>(m_k);
    if (m_n == 0.5) return m_k / simd::sqrt(p_star);
    return m_k * simd::pow(p_star, -m_n);
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
  PathEnd follow(double p_star, double volumetric_strain) const;

  /// The same from G and K/p* at the start, for |K volumetric_strain| <= p* simd::small_limit.
  template <class Real>
  PathEndOf<Real> follow_little(Real p_star, Real G, Real stiffness, Real volumetric_strain) const {
    const Real change = stiffness * volumetric_strain;
    if (m_n == 0.0) {
      const Real half = 0.5 * change;
      return grown(p_star, G, half, simd::small_expm1_ratio(half));
    }
    const Real ratio = root_growth_ratio(change);
    const Real growth = 1.0 + change * ratio;
    return {p_star * growth * growth,
            G * (ratio + m_n + m_n * change * ratio) * (1.0 / (0.5 + m_n))};
  }

  /// Elastic volumetric strain (negative) that lowers p* to the floor.
  double strain_to_pressure(double p_star, double floor) const {
    if (m_n == 0.0) return std::log(floor / p_star) / m_k;
    return (std::pow(floor, m_n) - std::pow(p_star, m_n)) / (m_n * m_k);
  }

 private:
  /// Half of the growth of ln p* and (exp(half) - 1)/half: sqrt(p*) grows to exp(half) of itself.
  template <class Real>
  static PathEndOf<Real> grown(Real p_star, Real G, Real half, Real ratio) {
    const Real growth = 1.0 + half * ratio;
    return {p_star * growth * growth, G * ratio};
  }
  PathEnd follow_power(double p_star, double volumetric_strain) const;

  /// sqrt(p*) grows to (1 + n w)^(1/2n) of itself where K/p* times the strain is w at the start:
  /// (that - 1)/w as its series, truncated below 1e-17.
  template <class Real>
  Real root_growth_ratio(Real w) const {
    Real sum = simd::splat<Real>(m_root_series.back());
    for (std::size_t j = m_root_series.size() - 1; j-- > 0;) sum = sum * w + m_root_series[j];
    return sum;
  }

  double m_G_of_root;
  double m_k, m_n;
  std::array<double, 10> m_root_series;
};

}  // namespace mpm::material
