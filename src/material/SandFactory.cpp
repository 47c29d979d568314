#include "mpm/material/SandFactory.hpp"

#include <cmath>

#include "mpm/material/SandLaw.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {

using options::between;
using options::not_negative;
using options::positive;

void SandFactory::declare(options::OptionSet& set) {
  set.section("Sand");
  declare_packing(set);
  declare_elasticity(set);
  declare_critical_state(set);
  declare_hardening(set);
  declare_cohesion(set);
  declare_numerics(set);
}

void SandFactory::declare_packing(options::OptionSet& set) {
  set.real("sand_void_ratio", m_sand.void_ratio, between(0.2, 2.0),
           {"1", "Initial void ratio e0.", "Section 4.1: dense 0.524, medium 0.657"});
  set.real("sand_Gs", m_sand.Gs, positive(),
           {"1", "Specific gravity of the grains; density is 1000 Gs/(1 + e0).", "Section 4.1"});
  set.real("sand_e_max", m_sand.e_max, positive(),
           {"1", "Void ratio of the loosest packing; for relative density only.", "Section 3.1"});
  set.real("sand_e_min", m_sand.e_min, positive(),
           {"1", "Void ratio of the densest packing; for relative density only.", "Section 3.1"});
}

void SandFactory::declare_elasticity(options::OptionSet& set) {
  set.real("sand_G0", m_sand.G0, positive(), {"1", "Elastic shear modulus, Eq. 15.", "Table 1"});
  set.real("sand_kappa", m_sand.kappa, positive(),
           {"1", "Elastic swelling, K = (1 + e0) p*/kappa.", "Table 1"});
}

void SandFactory::declare_critical_state(options::OptionSet& set) {
  // Below sqrt(2) - 1 the interpolation of Eq. 16 is not 1 in compression.
  const options::RealRange extension_ratio{
      .minimum = std::sqrt(2.0) - 1.0, .maximum = 1.0, .open_maximum = true};
  set.real("sand_Mc", m_sand.Mc,
           {.minimum = 0.0, .maximum = 3.0, .open_minimum = true, .open_maximum = true},
           {"1", "Critical stress ratio q/p in triaxial compression.", "Table 1"});
  set.real("sand_c", m_sand.c, extension_ratio,
           {"1", "Critical stress ratio in extension over that in compression.", "Table 1"});
  set.real("sand_e_Gamma", m_sand.e_Gamma, positive(),
           {"1", "Critical void ratio at 1 kPa (power form: at zero pressure).", "Table 1"});
  set.real(
      "sand_lambda_c", m_sand.lambda_c, not_negative(),
      {"1", "Slope of the critical line in e-ln p (power form: factor of (p/p_a)^xi).", "Table 1"});
  set.optional_real(
      "sand_xi", m_sand.xi, {.minimum = 0.0, .maximum = 1.0, .open_minimum = true},
      "straight critical line in e-ln p",
      {"1", "Exponent of the power form of critical line and bulk modulus.", "Eqs. 19 and 24"});
}

void SandFactory::declare_hardening(options::OptionSet& set) {
  set.real("sand_d0", m_sand.d0, not_negative(), {"1", "Dilatancy factor, Eq. 17.", "Table 1"});
  set.real("sand_m", m_sand.m, not_negative(),
           {"1", "Dependence of dilatancy on the state parameter, Eq. 17.", "Table 1"});
  set.real("sand_eps_r", m_sand.eps_r, positive(),
           {"1", "Reference strain of softening, Eq. 12.", "Table 1"});
  set.choice("sand_softening", m_sand.softening,
             {{"normalized", Softening::normalized},
              {"plain", Softening::plain},
              {"explicit", Softening::explicit_ratio}},
             {"1",
              "Reading of Eq. 12, x = eps_q/eps_r: f = x exp(1-x), f = x exp(-x), or the first "
              "with the hyperbolic part alone in D.",
              "chosen: see docs/model.md"});
}

void SandFactory::declare_cohesion(options::OptionSet& set) {
  set.real("sand_cohesion", m_sand.cohesion, not_negative(),
           {"Pa", "Cohesion c, a shift of the mean stress.", "Section 3.3"});
  set.choice("sand_cohesion_shift", m_sand.cohesion_shift,
             {{"plain", CohesionShift::plain}, {"cot_phi", CohesionShift::cot_phi}},
             {"1", "Shift of the mean stress: c, or c cot(phi_c).", "chosen: see docs/model.md"});
}

void SandFactory::declare_numerics(options::OptionSet& set) {
  set.real("sand_pressure_floor", m_sand.pressure_floor, positive(),
           {"Pa", "Lowest mean stress plus shift; below it the sand opens a gap.",
            "chosen: see docs/model.md"});
  set.real("sand_psi_cap", m_sand.psi_cap, {},
           {"1", "Largest state parameter in the dilatancy.", "chosen: see docs/model.md"});
  set.real("sand_tolerance", m_sand.tolerance, {.minimum = 1e-12, .maximum = 1e-2},
           {"1", "Relative error of the stress in one substep of the law.",
            "chosen: see docs/model.md"});
}

std::unique_ptr<Material> SandFactory::create() const {
  return std::make_unique<SandLaw>(m_sand);
}

}  // namespace mpm::material
