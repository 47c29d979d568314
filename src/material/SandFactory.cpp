#include "mpm/material/SandFactory.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "mpm/material/SandLaw.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {
namespace {

constexpr double loosest = -0.5, densest = 1.5;  // relative densities that are taken at all

}  // namespace

using options::between;
using options::not_negative;
using options::positive;

void SandFactory::declare(options::OptionSet& set) {
  m_options = &set;
  m_prefix = set.prefix();
  set.section("Sand");
  declare_name(set);
  declare_packing(set);
  declare_elasticity(set);
  declare_critical_state(set);
  declare_hardening(set);
  declare_cohesion(set);
  declare_numerics(set);
  set.rule([this] { check_together(); });
  set.caution([this] { return odd_packing(); });
}

/// The scene's packing stays: by its void ratio, or by relative density in another sand.
void SandFactory::take(const NamedSand& sand) {
  const double density = relative_density(m_sand);
  const bool same_limits =
      sand.constants.e_max == m_sand.e_max && sand.constants.e_min == m_sand.e_min;
  static_cast<SandConstants&>(m_sand) = sand.constants;
  if (!same_limits) m_sand.void_ratio = void_ratio_at(density, m_sand);
}

void SandFactory::declare_name(options::OptionSet& set) {
  std::vector<std::string> names;
  for (const NamedSand& sand : named_sands()) names.emplace_back(sand.name);
  set.preset(
      "sand", names, [this](std::size_t k) { take(named_sands()[k]); },
      {"",
       "Sand whose constants and readings are taken; single ones below override it. Where no "
       "packing is given, the scene's relative density stays.",
       "docs/sands.md"});
}

void SandFactory::declare_packing(options::OptionSet& set) {
  set.real("sand_void_ratio", m_sand.void_ratio, between(0.2, 2.0),
           {"1", "Initial void ratio e0.", "Section 4.1: dense 0.524, medium 0.657"});
  set.optional_real("sand_relative_density", m_relative_density, between(0.0, 1.2),
                    "as -sand_void_ratio says",
                    {"1", "Initial (e_max - e0)/(e_max - e_min), in place of -sand_void_ratio.",
                     "chosen: see docs/sands.md"});
  set.real("sand_Gs", m_sand.Gs, positive(),
           {"1", "Specific gravity of the grains; density is 1000 Gs/(1 + e0).", "Section 4.1"});
  set.real("sand_e_max", m_sand.e_max, positive(),
           {"1", "Void ratio of the loosest packing; for relative density only.", "Section 3.1"});
  set.real("sand_e_min", m_sand.e_min, positive(),
           {"1", "Void ratio of the densest packing; for relative density only.", "Section 3.1"});
  set.real(
      "sand_d50", m_sand.d50, positive(),
      {"m", "Mean diameter of the grains; no part of the law, only cells are compared with it.",
       "Section 3.1"});
}

void SandFactory::declare_elasticity(options::OptionSet& set) {
  set.real("sand_G0", m_sand.G0, positive(), {"1", "Elastic shear modulus, Eq. 15.", "Table 1"});
  set.choice(
      "sand_bulk", m_sand.bulk,
      {{"log", BulkModulus::log}, {"power", BulkModulus::power}, {"poisson", BulkModulus::poisson}},
      {"1",
       "Reading of Eq. 24: K = (1 + e0) p*/kappa, that over bulk_xi times "
       "(p_a/p*)^bulk_xi, or K from G and Poisson's ratio.",
       "chosen: see docs/model.md"});
  set.real("sand_kappa", m_sand.kappa, positive(),
           {"1", "Elastic swelling; without effect on -sand_bulk poisson.", "Table 1"});
  set.real("sand_bulk_xi", m_sand.bulk_xi, {.minimum = 0.0, .maximum = 1.0, .open_minimum = true},
           {"1", "Exponent of -sand_bulk power.", "Eq. 24"});
  set.real("sand_poisson", m_sand.poisson_ratio,
           {.minimum = -1.0, .maximum = 0.5, .open_minimum = true, .open_maximum = true},
           {"1", "Poisson's ratio of -sand_bulk poisson.", "chosen: see docs/model.md"});
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
  set.optional_real("sand_xi", m_sand.xi, {.minimum = 0.0, .maximum = 1.0, .open_minimum = true},
                    "straight critical line in e-ln p",
                    {"1", "Exponent of the power form of the critical line.", "Eq. 19"});
}

void SandFactory::declare_hardening(options::OptionSet& set) {
  set.real("sand_d0", m_sand.d0, not_negative(), {"1", "Dilatancy factor, Eq. 17.", "Table 1"});
  set.real("sand_m", m_sand.m, not_negative(),
           {"1", "Dependence of dilatancy on the state parameter, Eq. 17.", "Table 1"});
  set.real("sand_eps_r", m_sand.eps_r, positive(),
           {"1", "Reference strain of softening, Eq. 12.", "Table 1"});
  declare_readings(set);
}

void SandFactory::declare_readings(options::OptionSet& set) {
  set.choice("sand_softening", m_sand.softening,
             {{"normalized", Softening::normalized},
              {"plain", Softening::plain},
              {"explicit", Softening::explicit_ratio}},
             {"1",
              "Reading of Eq. 12, x = eps_q/eps_r: f = x exp(1-x), f = x exp(-x), or the first "
              "with the hyperbolic part alone in D.",
              "chosen: see docs/model.md"});
  set.choice("sand_dilatancy", m_sand.dilatancy,
             {{"printed", Dilatancy::printed}, {"lode", Dilatancy::lode}},
             {"1",
              "Reading of D in Eq. 12: d0 [exp(m psi) - eta/(Mc g)] as printed, or g times that, "
              "which limits the strength alike at every Lode angle.",
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
  set.optional_real("sand_gap_opening", m_sand.gap_opening, {.minimum = 1e-4, .maximum = 1.0},
                    "tension stays",
                    {"1",
                     "Volume strain of a gap over which the tension that cohesion leaves at the "
                     "floor fades to nothing, linearly.",
                     "chosen: see docs/model.md"});
  set.real("sand_psi_cap", m_sand.psi_cap, {},
           {"1", "Largest state parameter in the dilatancy.", "chosen: see docs/model.md"});
  set.real("sand_tolerance", m_sand.tolerance, {.minimum = 1e-12, .maximum = 1e-2},
           {"1", "Relative error of the stress in one substep of the law.",
            "chosen: see docs/model.md"});
}

void SandFactory::check_together() {
  set_packing();
  const auto without_effect = [&](const char* name, bool has_effect, const char* with) {
    if (has_effect || !m_options->is_changed(m_prefix + name)) return;
    const std::string remedy = fmt::format("-{}sand_bulk {}", m_prefix, with);
    throw options::bad_input({m_options->given(m_prefix + name), "has no effect here",
                              "with " + remedy, "leave it out or add " + remedy});
  };
  without_effect("sand_kappa", m_sand.bulk != BulkModulus::poisson, "log or power");
  without_effect("sand_bulk_xi", m_sand.bulk == BulkModulus::power, "power");
  without_effect("sand_poisson", m_sand.bulk == BulkModulus::poisson, "poisson");
  validate(m_sand, m_prefix);
  check_packing();
}

/// What experiments have never seen.
void SandFactory::check_packing() const {
  const double density = relative_density(m_sand);
  if (density >= loosest && density <= densest) return;
  throw options::bad_input(
      {m_options->given(m_prefix + "sand_void_ratio"),
       fmt::format("is a relative density of {:.3g}", density),
       fmt::format("{} to {}, void ratios of {:.4g} to {:.4g}", loosest, densest,
                   void_ratio_at(densest, m_sand), void_ratio_at(loosest, m_sand)),
       "correct it, or -sand_e_min and -sand_e_max"});
}

std::string SandFactory::odd_packing() const {
  const double density = relative_density(m_sand);
  if (density >= 0.0 && density <= 1.0) return {};
  return fmt::format(
      "-{}sand_void_ratio {} is a relative density of {:.3g}: the sand lies between {} and {} "
      "(-sand_e_min, -sand_e_max), and the law was not measured beyond",
      m_prefix, m_sand.void_ratio, density, m_sand.e_min, m_sand.e_max);
}

/// The void ratio from the relative density where that is given; the command line's word counts
/// where a file has the other one.
void SandFactory::set_packing() {
  if (!m_relative_density) return;
  const options::Given density = m_options->given(m_prefix + "sand_relative_density");
  const options::Given void_ratio = m_options->given(m_prefix + "sand_void_ratio");
  const bool both = m_options->is_given(void_ratio.name);
  if (both && density.is_from_command_line() == void_ratio.is_from_command_line())
    throw options::bad_input(
        {density, fmt::format("is given beside -{} {}", void_ratio.name, void_ratio.value),
         "one of the two", "leave one of them out"});
  if (!both || density.is_from_command_line())
    m_sand.void_ratio = void_ratio_at(*m_relative_density, m_sand);
  m_relative_density.reset();  // the void ratio says it from here on
}

std::unique_ptr<Material> SandFactory::create() const {
  return std::make_unique<SandLaw>(m_sand);
}

}  // namespace mpm::material
