#include "mpm/material/SandElasticity.hpp"

#include <algorithm>

namespace mpm::material {
namespace {

double exponent_of(const SandConstants& sand) {
  if (sand.bulk == BulkModulus::log) return 0.0;
  return sand.bulk == BulkModulus::power ? sand.bulk_xi : 0.5;
}

double factor_of(const SandConstants& sand, double void_ratio, double G_of_root) {
  if (sand.bulk == BulkModulus::poisson)
    return G_of_root * 2.0 * (1.0 + sand.poisson_ratio) / (3.0 * (1.0 - 2.0 * sand.poisson_ratio));
  const double slope = (1.0 + void_ratio) / sand.kappa;
  if (sand.bulk == BulkModulus::log) return slope;
  return slope / sand.bulk_xi * std::pow(atmospheric_pressure, sand.bulk_xi);
}

/// Coefficients of ((1 + n w)^(1/2n) - 1)/w in powers of w.
std::array<double, 10> root_series(double n) {
  std::array<double, 10> series{};
  double coefficient = 1.0;
  for (std::size_t j = 0; j < series.size(); ++j) {
    const auto power = static_cast<double>(j);
    coefficient *= (0.5 - power * n) / (power + 1.0);
    series[j] = coefficient;
  }
  return series;
}

}  // namespace

SandElasticity::SandElasticity(const SandConstants& sand, double void_ratio)
    : m_G_of_root(sand.G0 * (2.973 - void_ratio) * (2.973 - void_ratio) / (1.0 + void_ratio) *
                  std::sqrt(atmospheric_pressure)),
      m_k(factor_of(sand, void_ratio, m_G_of_root)),
      m_n(exponent_of(sand)),
      m_root_series(root_series(m_n)) {}

SandElasticity::PathEnd SandElasticity::follow(double p_star, double volumetric_strain) const {
  if (m_n != 0.0) return follow_power(p_star, volumetric_strain);
  const double half = 0.5 * m_k * volumetric_strain;
  const double ratio = std::abs(half) > 1e-8 ? std::expm1(half) / half : 1.0 + 0.5 * half;
  return grown(p_star, shear_modulus(p_star), half, ratio);
}

/// y = p*^n is linear in strain, dy = n k deps, and G grows like y^(1/2n).
SandElasticity::PathEnd SandElasticity::follow_power(double p_star,
                                                     double volumetric_strain) const {
  const double power = 0.5 / m_n;
  const double root0 = std::sqrt(p_star), y0 = std::pow(p_star, m_n);
  const double change = m_n * m_k * volumetric_strain;
  const double y1 = std::max(y0 + change, 0.0);                // 0: down to no pressure
  const double root1 = y1 <= 0.0 ? 0.0 : std::pow(y1, power);  // and NaN where y1 is
  double mean_root = 0.0;
  if (std::abs(change) < 1e-3 * y0)
    mean_root = (root0 + 4.0 * std::pow(y0 + 0.5 * change, power) + root1) / 6.0;
  else if (!(y1 <= 0.0))
    mean_root = (y1 * root1 - y0 * root0) / ((power + 1.0) * change);
  return {root1 * root1, m_G_of_root * mean_root};
}

}  // namespace mpm::material
