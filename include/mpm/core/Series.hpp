#pragma once

#include <type_traits>

#include "mpm/core/Simd.hpp"

/// Elementary functions of small arguments by short series, and powers, for Pack and double.
namespace mpm::simd {

/// What a comparison of two of them gives.
template <class Real>
using MaskOf = std::conditional_t<std::is_same_v<Real, Pack>, Mask, bool>;

/// x in every lane.
template <class Real>
Real splat(double x) {
  if constexpr (std::is_same_v<Real, Pack>)
    return broadcast(x);
  else
    return x;
}

/// Largest argument of the small_ functions.
inline constexpr double small_limit = 1.0 / 32.0;

/// (exp(x) - 1)/x for |x| <= small_limit, truncated below 1e-17.
template <class Real>
Real small_expm1_ratio(Real x) {
  const Real x2 = x * x, x4 = x2 * x2;
  const Real p01 = x * (1.0 / 2.0) + 1.0, p23 = x * (1.0 / 24.0) + 1.0 / 6.0;
  const Real p45 = x * (1.0 / 720.0) + 1.0 / 120.0, p67 = x * (1.0 / 40320.0) + 1.0 / 5040.0;
  return (p67 * x2 + p45) * x4 + (p23 * x2 + p01);
}

/// exp(x) for |x| <= small_limit.
template <class Real>
Real small_exp(Real x) {
  return x * small_expm1_ratio(x) + 1.0;
}

/// log(1 + x) for |x| <= small_limit, truncated below 1e-17.
template <class Real>
Real small_log1p(Real x) {
  const Real x2 = x * x, x4 = x2 * x2;
  const Real p01 = x * (-1.0 / 2.0) + 1.0, p23 = x * (-1.0 / 4.0) + 1.0 / 3.0;
  const Real p45 = x * (-1.0 / 6.0) + 1.0 / 5.0, p67 = x * (-1.0 / 8.0) + 1.0 / 7.0;
  const Real p89 = x * (-1.0 / 10.0) + 1.0 / 9.0;
  return x * (((p89 * x4) + (p67 * x2 + p45)) * x4 + (p23 * x2 + p01));
}

/// x^y for x > 0.
inline double pow(double x, double y) {
  return std::pow(x, y);
}
/// Relative error some y log(x) times that of a double.
inline Pack pow(Pack x, double y) {
  return exp(y * log(x));
}

}  // namespace mpm::simd
