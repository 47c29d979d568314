#pragma once

#include <algorithm>
#include <cmath>

#include "mpm/material/SandElasticity.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// A state of the sand as its loading surface sees it; compression positive.
struct SurfaceState {
  double p_star;      ///< p + p_c, Pa
  double void_ratio;  ///< of the skeleton
  double eps_q;       ///< deviatoric strain measure of Eq. 12
  double sin3theta;   ///< -1 in triaxial compression, 1 in extension
};

/// The loading surface at a state, with the parts that its slopes share.
struct SurfacePoint {
  double qhat;  ///< q on the surface, Pa, never negative
  double G;     ///< elastic shear modulus, Pa
  double M;     ///< critical stress ratio at this Lode angle
  double dM;    ///< dM/dsin3theta
  double A;     ///< d0 exp(m psi)
  double psi;   ///< state parameter, uncapped
  double f;     ///< softening function of x = eps_q/eps_r
  double df;    ///< df/deps_q
  double h;     ///< hyperbolic part eps_q/(a + b eps_q), Pa
  double s;     ///< 1/(1 - f d0/M), or 1 where D does not hold q
};

/// Slopes of qhat.
struct SurfaceSlopes {
  double C;  ///< dqhat/dp
  double E;  ///< dqhat/de, Pa
  double F;  ///< dqhat/deps_q, Pa
  double T;  ///< dqhat/dsin3theta, Pa
};

/// The relation q = h - f D p* of Eq. 12 (Yang, Xu & Li 2019), solved for q.
class LoadingSurface {
 public:
  explicit LoadingSurface(const SandParameters& sand);

  const SandElasticity& elasticity() const { return m_elasticity; }

  SurfacePoint at(const SurfaceState& y) const {
    SurfacePoint point;
    point.G = m_elasticity.shear_modulus_of_root(std::sqrt(y.p_star));

    // Eq. 16 with the numerator rationalised: no 0/0 at sin3theta = 0.
    const double root = std::sqrt(std::max(m_root0 + m_root1 * y.sin3theta, 1e-12));
    const double denominator = root + m_g1;
    point.M = m_g0 / denominator;
    point.dM = -0.5 * m_root1 * point.M / (denominator * root);
    const double d0_M = m_d0 * denominator / m_g0;

    point.psi = y.void_ratio - critical_void_ratio(y.p_star);
    point.A = m_d0 * std::exp(m_m * std::min(point.psi, m_psi_cap));

    const double x = y.eps_q * m_inverse_eps_r;
    const double decay = std::exp(m_softening_shift - x);
    point.f = x * decay;
    point.df = (1.0 - x) * decay * m_inverse_eps_r;

    // h = eps_q/(a + b eps_q) with a = 1/(3G), b = 1/(M p*).
    const double initial = 3.0 * point.G * y.eps_q;
    const double ultimate = point.M * y.p_star;
    point.h = initial * ultimate / (initial + ultimate);

    const double softening = point.f * point.A * y.p_star;
    point.s = m_ratio_holds_q ? 1.0 / (1.0 - point.f * d0_M) : 1.0;
    const double gain = m_ratio_holds_q ? 1.0 : 1.0 + point.f * d0_M;
    point.qhat = std::max(point.s * (gain * point.h - softening), 0.0);
    return point;
  }

  SurfaceSlopes slopes(const SurfaceState& y, const SurfacePoint& point) const {
    if (point.qhat <= 0.0 && y.eps_q > 0.0) return {0.0, 0.0, 0.0, 0.0};
    const auto& [qhat, G, M, dM, A, psi, f, df, h, s] = point;
    const double d0_M = m_d0 / M;
    const double gain = m_ratio_holds_q ? 1.0 : 1.0 + f * d0_M;
    const double ratio_stress = m_ratio_holds_q ? qhat : h;
    const double m_active = psi < m_psi_cap ? m_m : 0.0;

    const double initial = 3.0 * G * y.eps_q;
    const double ultimate = M * y.p_star;
    const double share = 1.0 / (initial + ultimate);
    const double remainder = ultimate * share;  // a/(a + b eps_q)
    const double h_p = h * (0.5 * ultimate + initial) * share / y.p_star;
    const double h_eps = 3.0 * G * remainder * remainder;
    const double h_M = h * h / (M * ultimate);

    const double fA = f * A;
    SurfaceSlopes slope;
    slope.C = s * (gain * h_p - fA - fA * m_active * critical_slope(y.p_star));
    slope.E = -s * fA * m_active * y.p_star;
    slope.F = s * (gain * h_eps - df * (y.p_star * A - ratio_stress * d0_M));
    slope.T = s * (gain * h_M - ratio_stress * f * d0_M / M) * dM;
    return slope;
  }

  /// D of Eq. 17 at the stress ratio eta = q/p*.
  double dilatancy(const SurfacePoint& point, double eta) const {
    return point.A - m_d0 * eta / point.M;
  }

  double critical_void_ratio(double p_star) const {
    if (m_xi > 0.0) return m_e_Gamma - m_lambda_c * std::pow(p_star / atmospheric_pressure, m_xi);
    return m_e_Gamma - m_lambda_c * std::log(1e-3 * p_star);
  }

  bool is_capped(const SurfacePoint& point) const { return point.psi >= m_psi_cap; }

 private:
  /// -de_c/dln p*.
  double critical_slope(double p_star) const {
    if (m_xi > 0.0) return m_lambda_c * m_xi * std::pow(p_star / atmospheric_pressure, m_xi);
    return m_lambda_c;
  }

  SandElasticity m_elasticity;
  double m_root0, m_root1, m_g0, m_g1;
  double m_e_Gamma, m_lambda_c, m_xi;
  double m_d0, m_m, m_psi_cap;
  double m_inverse_eps_r, m_softening_shift;
  bool m_ratio_holds_q;
};

}  // namespace mpm::material
