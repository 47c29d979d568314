#pragma once

#include "mpm/material/LoadingSurface.hpp"

namespace mpm::material {

// Limits that the two ways of integrating the law share.
inline constexpr double surface_tolerance = 1e-8;    // of p*
inline constexpr double vanishing_ratio = 1e-9;      // q/p* below which s has no direction
inline constexpr double largest_elastic_part = 0.5;  // relative change of stress between checks

/// A strain increment as the flow sees it; compression positive.
template <class Real>
struct SandStraining {
  Real eps_v;      ///< volumetric
  Real eps_q;      ///< sqrt(2/3) n : de
  Real sin3theta;  ///< by the elastic stress increment; the plastic one is radial, turns nothing
};

/// The increments that follow from a strain increment at a state on the surface.
template <class Real>
struct SandFlow {
  Real p_star;
  Real eps_q;   ///< of the strain measure of Eq. 12
  Real lambda;  ///< of plastic deviatoric strain
  simd::MaskOf<Real> loading;
};

/// Eq. 23.
template <class Real>
[[gnu::always_inline]] inline SandFlow<Real> sand_flow(const LoadingSurface& surface,
                                                       const SurfaceStateOf<Real>& y,
                                                       const SurfacePointOf<Real>& point, Real q,
                                                       const SandStraining<Real>& d) {
  const auto [C, E, F, T] = surface.slopes(y, point);
  const Real G = point.G;
  const Real K = point.stiffness * y.p_star;
  const Real KD = point.stiffness * surface.dilatancy_stress(point, y.p_star, q);

  // The excess of an elastic step over the surface at constant eps_q.
  const Real specific_volume = 1.0 + y.void_ratio;
  const Real X = 3.0 * G * d.eps_q - (C * K - E * specific_volume) * d.eps_v - T * d.sin3theta;
  // eps_q grows only: letting it shrink where q falls would ratchet.
  const Real growth = simd::max(d.eps_q, Real{});
  const Real beyond = X - F * growth;
  const simd::MaskOf<Real> plastic = beyond > 0.0, outward = X > 0.0, loading = plastic | outward;
  // Nearly isotropic compression leaves the surface with lambda < 0: the strain is elastic and
  // eps_q follows so that q stays on the surface.
  const Real denominator =
      simd::select(plastic, simd::max(Real(3.0 * G - C * KD), Real(1e-3 * G)), F);
  const Real ratio = simd::select(plastic, beyond, X) / simd::select(loading, denominator, G);
  const Real lambda = simd::select(plastic, ratio, Real{});
  return {K * d.eps_v - KD * lambda,
          simd::select(plastic, growth, simd::select(outward, ratio, Real{})), lambda, loading};
}

}  // namespace mpm::material
