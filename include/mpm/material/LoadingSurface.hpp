#pragma once

#include <cmath>

#include "mpm/core/Series.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/material/SandElasticity.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// A state of the sand as its loading surface sees it; compression positive. `Real` is double, or
/// simd::Pack for four states at a time.
template <class Real>
struct SurfaceStateOf {
  Real p_star;      ///< p + p_c, Pa
  Real void_ratio;  ///< of the skeleton
  Real eps_q;       ///< deviatoric strain measure of Eq. 12
  Real sin3theta;   ///< -1 in triaxial compression, 1 in extension
};

/// From one state to another.
template <class Real>
struct SurfaceChange {
  Real relative_pressure;  ///< dp*/p*
  Real void_ratio;
  Real eps_q;
};

/// The parts of the loading surface that are not algebraic.
template <class Real>
struct SurfaceFactors {
  Real psi;    ///< state parameter, uncapped
  Real A;      ///< d0 exp(m psi)
  Real decay;  ///< f/x, x = eps_q/eps_r
};

/// The loading surface at a state, with the parts that its slopes share.
template <class Real>
struct SurfacePointOf {
  Real qhat;       ///< q on the surface, Pa, never negative
  Real G;          ///< elastic shear modulus, Pa
  Real M;          ///< critical stress ratio at this Lode angle
  Real dM;         ///< dM/dsin3theta
  Real inverse_M;  ///< 1/M
  Real A;          ///< d0 exp(m psi)
  Real psi;        ///< state parameter, uncapped
  Real f;          ///< softening function of x = eps_q/eps_r
  Real df;         ///< df/deps_q
  Real rise;       ///< 3G eps_q/(3G eps_q + M p*)
  Real remainder;  ///< 1 - rise
  Real s;          ///< 1/(1 - f d0/M), or 1 where D does not hold q
};

/// Slopes of qhat.
template <class Real>
struct SurfaceSlopesOf {
  Real C;  ///< dqhat/dp
  Real E;  ///< dqhat/de, Pa
  Real F;  ///< dqhat/deps_q, Pa
  Real T;  ///< dqhat/dsin3theta, Pa
};

using SurfaceState = SurfaceStateOf<double>;
using SurfacePoint = SurfacePointOf<double>;
using SurfaceSlopes = SurfaceSlopesOf<double>;

/// The relation q = h - f D p* of Eq. 12 (Yang, Xu & Li 2019), solved for q.
class LoadingSurface {
 public:
  explicit LoadingSurface(const SandParameters& sand);

  const SandElasticity& elasticity() const { return m_elasticity; }

  template <class Real = double>
  SurfacePointOf<Real> at(const SurfaceStateOf<Real>& y) const {
    return at(y, factors(y));
  }

  template <class Real>
  SurfacePointOf<Real> at(const SurfaceStateOf<Real>& y, const SurfaceFactors<Real>& part) const {
    SurfacePointOf<Real> point;
    point.G = m_elasticity.shear_modulus_of_root(simd::sqrt(y.p_star));

    // Eq. 16 with the numerator rationalised: no 0/0 at sin3theta = 0.
    const Real root =
        simd::sqrt(simd::max(m_root0 + m_root1 * y.sin3theta, simd::splat<Real>(1e-12)));
    const Real denominator = root + m_g1;
    const Real inverse = 1.0 / (denominator * root);
    point.M = m_g0 * root * inverse;
    point.dM = -0.5 * m_root1 * point.M * inverse;
    point.inverse_M = m_inverse_g0 * denominator;
    const Real d0_M = m_d0 * point.inverse_M;

    point.psi = part.psi;
    point.A = part.A;
    const Real x = y.eps_q * m_inverse_eps_r;
    point.f = x * part.decay;
    point.df = (1.0 - x) * part.decay * m_inverse_eps_r;

    // h = eps_q/(a + b eps_q) with a = 1/(3G), b = 1/(M p*).
    const Real initial = 3.0 * point.G * y.eps_q;
    const Real ultimate = point.M * y.p_star;
    const Real share = 1.0 / (initial + ultimate);
    point.rise = initial * share;
    point.remainder = ultimate * share;
    const Real h = point.rise * ultimate;

    const Real softening = point.f * point.A * y.p_star;
    if (m_ratio_holds_q) {
      point.s = 1.0 / (1.0 - point.f * d0_M);
      point.qhat = simd::max(point.s * (h - softening), Real{});
    } else {
      point.s = simd::splat<Real>(1.0);
      point.qhat = simd::max((1.0 + point.f * d0_M) * h - softening, Real{});
    }
    return point;
  }

  template <class Real>
  SurfaceSlopesOf<Real> slopes(const SurfaceStateOf<Real>& y,
                               const SurfacePointOf<Real>& point) const {
    const auto& [qhat, G, M, dM, inverse_M, A, psi, f, df, rise, remainder, s] = point;
    const Real d0_M = m_d0 * inverse_M;
    const Real h = rise * M * y.p_star;
    const Real gain = m_ratio_holds_q ? simd::splat<Real>(1.0) : 1.0 + f * d0_M;
    const Real ratio_stress = m_ratio_holds_q ? qhat : h;
    const Real m_active = simd::select(psi < m_psi_cap, simd::splat<Real>(m_m), Real{});

    const Real h_p = M * rise * (0.5 * remainder + rise);
    const Real h_eps = 3.0 * G * remainder * remainder;
    const Real h_M = rise * rise * y.p_star;

    const Real fA = f * A;
    // The surface is cut off at q = 0, but begins there too.
    const Real factor = simd::select((qhat <= 0.0) & (y.eps_q > 0.0), Real{}, s);
    SurfaceSlopesOf<Real> slope;
    slope.C = factor * (gain * h_p - fA - fA * m_active * critical_slope(y.p_star));
    slope.E = -factor * fA * m_active * y.p_star;
    slope.F = factor * (gain * h_eps - df * (y.p_star * A - ratio_stress * d0_M));
    slope.T = factor * (gain * h_M - ratio_stress * f * d0_M * inverse_M) * dM;
    return slope;
  }

  template <class Real>
  SurfaceFactors<Real> factors(const SurfaceStateOf<Real>& y) const {
    const Real psi = y.void_ratio - critical_void_ratio(y.p_star);
    return {psi, m_d0 * simd::exp(m_m * capped(psi)),
            simd::exp(m_softening_shift - y.eps_q * m_inverse_eps_r)};
  }

  /// factors(y) from `before` at a state `change` before y, without logarithm and exponentials.
  template <class Real>
  SurfaceFactors<Real> factors_nearby(const SurfaceStateOf<Real>& y,
                                      const SurfaceFactors<Real>& before,
                                      const SurfaceChange<Real>& change) const {
    if (m_xi > 0.0) return factors(y);
    const Real psi =
        before.psi + change.void_ratio + m_lambda_c * simd::small_log1p(change.relative_pressure);
    return {psi, before.A * simd::small_exp(m_m * (capped(psi) - capped(before.psi))),
            before.decay * simd::small_exp(-change.eps_q * m_inverse_eps_r)};
  }

  /// Where factors_nearby() is exact.
  template <class Real>
  simd::MaskOf<Real> is_nearby(const SurfaceChange<Real>& change) const {
    constexpr double limit = simd::small_limit;
    return (simd::abs(change.relative_pressure) <= limit) &
           (simd::abs(change.void_ratio) * m_m <= 0.5 * limit) &
           (simd::abs(change.relative_pressure) * (1.1 * m_m * m_lambda_c) <= 0.5 * limit) &
           (simd::abs(change.eps_q) * m_inverse_eps_r <= limit);
  }

  /// D p* with D of Eq. 17, Pa.
  template <class Real>
  Real dilatancy_stress(const SurfacePointOf<Real>& point, Real p_star, Real q) const {
    return point.A * p_star - m_d0 * point.inverse_M * q;
  }

  template <class Real>
  Real critical_void_ratio(Real p_star) const {
    if (m_xi > 0.0)
      return m_e_Gamma - m_lambda_c * simd::pow(p_star * (1.0 / atmospheric_pressure), m_xi);
    return m_e_Gamma - m_lambda_c * simd::log(1e-3 * p_star);
  }

  bool is_capped(const SurfacePoint& point) const { return point.psi >= m_psi_cap; }

 private:
  /// -de_c/dln p*.
  template <class Real>
  Real critical_slope(Real p_star) const {
    if (m_xi > 0.0)
      return m_lambda_c * m_xi * simd::pow(p_star * (1.0 / atmospheric_pressure), m_xi);
    return simd::splat<Real>(m_lambda_c);
  }
  template <class Real>
  Real capped(Real psi) const {
    return simd::min(psi, simd::splat<Real>(m_psi_cap));
  }

  SandElasticity m_elasticity;
  double m_root0, m_root1, m_g0, m_inverse_g0, m_g1;
  double m_e_Gamma, m_lambda_c, m_xi;
  double m_d0, m_m, m_psi_cap;
  double m_inverse_eps_r, m_softening_shift;
  bool m_ratio_holds_q;
};

}  // namespace mpm::material
