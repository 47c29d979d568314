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
  Real psi;             ///< state parameter, uncapped
  Real A;               ///< d0 exp(m psi)
  Real decay;           ///< f/x, x = eps_q/eps_r
  Real critical_slope;  ///< -de_c/dln p*
  Real stiffness;       ///< K/p*
};

/// The loading surface at a state, with the parts that its slopes share.
template <class Real>
struct SurfacePointOf {
  Real qhat;            ///< q on the surface, Pa, never negative
  Real G;               ///< elastic shear modulus, Pa
  Real M;               ///< critical stress ratio at this Lode angle
  Real dM;              ///< dM/dsin3theta
  Real inverse_M;       ///< 1/M
  Real A;               ///< D at no stress ratio: d0 exp(m psi), times g where D is free of it
  Real B;               ///< -dD/deta: d0/M, or d0/Mc where D is free of g
  Real psi;             ///< state parameter, uncapped
  Real f;               ///< softening function of x = eps_q/eps_r
  Real df;              ///< df/deps_q
  Real rise;            ///< 3G eps_q/(3G eps_q + M p*)
  Real remainder;       ///< 1 - rise
  Real s;               ///< 1/(1 - f B), or 1 where D does not hold q
  Real critical_slope;  ///< -de_c/dln p*
  Real stiffness;       ///< K/p*
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

    point.psi = part.psi;
    point.critical_slope = part.critical_slope;
    point.stiffness = part.stiffness;
    point.A = m_lode_free ? Real(part.A * (point.M * m_inverse_Mc)) : part.A;
    point.B = m_lode_free ? simd::splat<Real>(m_d0 * m_inverse_Mc) : Real(m_d0 * point.inverse_M);
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
      point.s = 1.0 / (1.0 - point.f * point.B);
      point.qhat = simd::max(point.s * (h - softening), Real{});
    } else {
      point.s = simd::splat<Real>(1.0);
      point.qhat = simd::max((1.0 + point.f * point.B) * h - softening, Real{});
    }
    return point;
  }

  template <class Real>
  SurfaceSlopesOf<Real> slopes(const SurfaceStateOf<Real>& y,
                               const SurfacePointOf<Real>& point) const {
    const auto& [qhat, G, M, dM, inverse_M, A, B, psi, f, df, rise, remainder, s, critical_slope,
                 stiffness] = point;
    const Real h = rise * M * y.p_star;
    const Real gain = m_ratio_holds_q ? simd::splat<Real>(1.0) : 1.0 + f * B;
    const Real ratio_stress = m_ratio_holds_q ? qhat : h;
    const Real m_active = simd::select(psi < m_psi_cap, simd::splat<Real>(m_m), Real{});

    const Real h_p = M * rise * (0.5 * remainder + rise);
    const Real h_eps = 3.0 * G * remainder * remainder;
    const Real h_M = rise * rise * y.p_star;
    // p* dD/dM times M: by B as printed, by A where D is free of g.
    const Real turned = m_lode_free ? Real(A * y.p_star * f) : Real(ratio_stress * f * B);

    const Real fA = f * A;
    // The surface is cut off at q = 0, but begins there too.
    const Real factor = simd::select((qhat <= 0.0) & (y.eps_q > 0.0), Real{}, s);
    SurfaceSlopesOf<Real> slope;
    slope.C = factor * (gain * h_p - fA - fA * m_active * critical_slope);
    slope.E = -factor * fA * m_active * y.p_star;
    slope.F = factor * (gain * h_eps - df * (y.p_star * A - ratio_stress * B));
    slope.T = factor * (gain * h_M - turned * inverse_M) * dM;
    return slope;
  }

  template <class Real>
  SurfaceFactors<Real> factors(const SurfaceStateOf<Real>& y) const {
    const Real log_p = simd::log(1e-3 * y.p_star);  // p* in kPa, as e_Gamma is
    const Real slope = critical_slope(log_p);
    const Real psi = y.void_ratio - critical_void_ratio(log_p, slope);
    return {psi, m_d0 * simd::exp(m_m * capped(psi)),
            simd::exp(m_softening_shift - y.eps_q * m_inverse_eps_r), slope,
            stiffness(y.p_star, log_p)};
  }

  /// factors(y) from `before` at a state `change` before y, without logarithm and exponentials.
  template <class Real>
  SurfaceFactors<Real> factors_nearby(const SurfaceStateOf<Real>& y,
                                      const SurfaceFactors<Real>& before,
                                      const SurfaceChange<Real>& change) const {
    SurfaceFactors<Real> now = before;
    const Real log_growth = simd::small_log1p(change.relative_pressure);
    if (m_xi > 0.0) {
      const Real growth = m_xi * log_growth;
      now.psi = before.psi + change.void_ratio +
                before.critical_slope * (log_growth * simd::small_expm1_ratio(growth));
      now.critical_slope = before.critical_slope * simd::small_exp(growth);
    } else {
      now.psi = before.psi + change.void_ratio + m_lambda_c * log_growth;
    }
    now.A = before.A * simd::small_exp(m_m * (capped(now.psi) - capped(before.psi)));
    now.decay = before.decay * simd::small_exp(-change.eps_q * m_inverse_eps_r);
    now.stiffness = stiffness_nearby(y.p_star, before.stiffness, log_growth);
    return now;
  }

  /// Where factors_nearby() is exact.
  template <class Real>
  simd::MaskOf<Real> is_nearby(const SurfaceChange<Real>& change, Real critical_slope) const {
    constexpr double limit = simd::small_limit;
    return (simd::abs(change.relative_pressure) <= limit) &
           (simd::abs(change.void_ratio) * m_m <= 0.5 * limit) &
           (simd::abs(change.relative_pressure) * (1.1 * m_m * critical_slope) <= 0.5 * limit) &
           (simd::abs(change.eps_q) * m_inverse_eps_r <= limit);
  }

  /// D p* with D of Eq. 17, Pa.
  template <class Real>
  Real dilatancy_stress(const SurfacePointOf<Real>& point, Real p_star, Real q) const {
    return point.A * p_star - point.B * q;
  }

  template <class Real>
  Real critical_void_ratio(Real p_star) const {
    const Real log_p = simd::log(1e-3 * p_star);
    return critical_void_ratio(log_p, critical_slope(log_p));
  }

  bool is_capped(const SurfacePoint& point) const { return point.psi >= m_psi_cap; }

 private:
  /// -de_c/dln p* from ln p*/kPa: lambda_c, or lambda_c xi (p*/p_a)^xi.
  template <class Real>
  Real critical_slope(Real log_p) const {
    if (m_xi > 0.0) return m_slope_at_1kPa * simd::exp(m_xi * log_p);
    return simd::splat<Real>(m_lambda_c);
  }
  template <class Real>
  Real critical_void_ratio(Real log_p, Real slope) const {
    if (m_xi > 0.0) return m_e_Gamma - slope * m_inverse_xi;
    return m_e_Gamma - m_lambda_c * log_p;
  }
  /// K/p*; the powers but the square root share the logarithm.
  template <class Real>
  Real stiffness(Real p_star, Real log_p) const {
    const double n = m_elasticity.exponent();
    if (n == 0.0 || n == 0.5) return m_elasticity.stiffness(p_star);
    return m_stiffness_at_1kPa * simd::exp(-n * log_p);
  }
  template <class Real>
  Real stiffness_nearby(Real p_star, Real before, Real log_growth) const {
    const double n = m_elasticity.exponent();
    if (n == 0.0) return before;
    if (n == 0.5) return m_elasticity.stiffness(p_star);
    return before * simd::small_exp(-n * log_growth);
  }
  template <class Real>
  Real capped(Real psi) const {
    return simd::min(psi, simd::splat<Real>(m_psi_cap));
  }

  SandElasticity m_elasticity;
  double m_root0, m_root1, m_g0, m_inverse_g0, m_g1;
  double m_inverse_Mc;
  double m_e_Gamma, m_lambda_c, m_xi, m_inverse_xi, m_slope_at_1kPa;
  double m_stiffness_at_1kPa;
  double m_d0, m_m, m_psi_cap;
  double m_inverse_eps_r, m_softening_shift;
  bool m_ratio_holds_q, m_lode_free;
};

}  // namespace mpm::material
