#include "mpm/material/SandElasticity.hpp"

namespace mpm::material {

SandElasticity::SandElasticity(const SandParameters& sand)
    : m_G_of_root(sand.G0 * (2.973 - sand.void_ratio) * (2.973 - sand.void_ratio) /
                  (1.0 + sand.void_ratio) * std::sqrt(atmospheric_pressure)),
      m_stiffness((1.0 + sand.void_ratio) / sand.kappa),
      m_power_form(sand.xi.has_value()) {
  if (!m_power_form) return;
  m_xi = *sand.xi;
  m_power_stiffness = m_stiffness * std::pow(atmospheric_pressure, m_xi);
}

SandElasticity::PathEnd SandElasticity::follow_power(double p_star,
                                                     double volumetric_strain) const {
  // Eq. 24 makes y = p*^xi linear in strain; G grows like y^n.
  const double n = 0.5 / m_xi;
  const double y0 = std::pow(p_star, m_xi);
  const double change = m_power_stiffness * volumetric_strain;
  const double y1 = y0 + change;
  if (y1 <= 0.0) return {0.0, 0.0};
  const double root1 = std::pow(y1, n);
  if (std::abs(change) < 1e-3 * y0) {
    const double middle = std::pow(y0 + 0.5 * change, n);
    const double simpson = (std::sqrt(p_star) + 4.0 * middle + root1) / 6.0;
    return {root1 * root1, m_G_of_root * simpson};
  }
  const double integral = (y1 * root1 - y0 * std::sqrt(p_star)) / ((n + 1.0) * change);
  return {root1 * root1, m_G_of_root * integral};
}

}  // namespace mpm::material
