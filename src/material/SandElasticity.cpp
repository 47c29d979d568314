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

}  // namespace mpm::material
