#include "mpm/material/LoadingSurface.hpp"

namespace mpm::material {

LoadingSurface::LoadingSurface(const SandParameters& sand)
    : m_elasticity(sand, sand.void_ratio),
      m_root0((1.0 + sand.c * sand.c) * (1.0 + sand.c * sand.c)),
      m_root1(4.0 * sand.c * (1.0 - sand.c * sand.c)),
      m_g0(sand.Mc * 2.0 * sand.c * (1.0 + sand.c)),
      m_inverse_g0(1.0 / m_g0),
      m_g1(1.0 + sand.c * sand.c),
      m_inverse_Mc(1.0 / sand.Mc),
      m_e_Gamma(sand.e_Gamma),
      m_lambda_c(sand.lambda_c),
      m_xi(sand.xi.value_or(0.0)),
      m_inverse_xi(sand.xi ? 1.0 / *sand.xi : 0.0),
      m_slope_at_1kPa(sand.lambda_c * m_xi * std::pow(1e3 / atmospheric_pressure, m_xi)),
      m_stiffness_at_1kPa(m_elasticity.stiffness(1e3)),
      m_d0(sand.d0),
      m_m(sand.m),
      m_psi_cap(sand.psi_cap),
      m_inverse_eps_r(1.0 / sand.eps_r),
      m_softening_shift(sand.softening == Softening::plain ? 0.0 : 1.0),
      m_ratio_holds_q(sand.softening != Softening::explicit_ratio),
      m_lode_free(sand.dilatancy == Dilatancy::lode) {}

}  // namespace mpm::material
