#include "mpm/material/SandParameters.hpp"

#include <fmt/format.h>

#include <cmath>

#include "mpm/core/Errors.hpp"

namespace mpm::material {

double critical_friction_angle(const SandConstants& sand) {
  return std::asin(3.0 * sand.Mc / (6.0 + sand.Mc));
}

double cohesion_shift(const SandParameters& sand) {
  if (sand.cohesion_shift == CohesionShift::plain) return sand.cohesion;
  return sand.cohesion / std::tan(critical_friction_angle(sand));
}

double relative_density(const SandParameters& sand) {
  return (sand.e_max - sand.void_ratio) / (sand.e_max - sand.e_min);
}

double void_ratio_at(double relative_density, const SandConstants& sand) {
  return sand.e_max - relative_density * (sand.e_max - sand.e_min);
}

namespace {

void require(bool holds, const std::string& message) {
  if (!holds) throw BadInput(message);
}

/// Eq. 12 is solved for q by dividing by 1 - f B, which must stay positive at every Lode angle.
void require_solvable(const SandParameters& sand, const std::string& prefix) {
  if (sand.softening == Softening::explicit_ratio) return;
  const double largest_f = sand.softening == Softening::plain ? std::exp(-1.0) : 1.0;
  const bool lode = sand.dilatancy == Dilatancy::lode;
  const double limit = (lode ? 1.0 : sand.c) * sand.Mc / largest_f;
  require(
      sand.d0 < limit,
      fmt::format("-{0}sand_d0 {1}: must be below {2:.4g} ({3}-{0}sand_Mc over the largest f), or "
                  "the stress-strain relation has no solution for q; lower -{0}sand_d0",
                  prefix, sand.d0, limit,
                  lode ? std::string() : fmt::format("-{}sand_c times ", prefix)));
}

}  // namespace

void validate(const SandParameters& sand, const std::string& prefix) {
  require_solvable(sand, prefix);
  require(sand.e_min < sand.e_max,
          fmt::format("-{0}sand_e_min {1}: must be below -{0}sand_e_max {2}", prefix, sand.e_min,
                      sand.e_max));
  require(
      sand.void_ratio < 2.973,
      fmt::format("-{}sand_void_ratio {}: must be below 2.973, where the shear modulus of Eq. 15 "
                  "vanishes",
                  prefix, sand.void_ratio));
}

}  // namespace mpm::material
