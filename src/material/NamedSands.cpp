#include "mpm/material/NamedSands.hpp"

#include <array>

namespace mpm::material {
namespace {

SandConstants stockton_paper() {
  return {};  // Table 1 is what SandConstants begins with
}

/// Friction angles at the peak are about alike in triaxial compression and extension, which is
/// c = 0.65 at 40 degrees; Ottawa sand has 0.652, Toyoura 0.68 (docs/sands.md).
constexpr double equal_angles_at_the_peak = 0.65;
constexpr double bridges_break = 0.01;  // a band of 10 to 20 grains opens by 0.1 to 0.2 of one

SandConstants stockton() {
  SandConstants sand = stockton_paper();
  sand.c = equal_angles_at_the_peak;
  sand.dilatancy = Dilatancy::lode;
  sand.bulk = BulkModulus::power;
  sand.bulk_xi = 0.5;
  sand.gap_opening = bridges_break;
  return sand;
}

/// Elasticity and critical line by Dafalias & Manzari (2004); d0, m, eps_r, Poisson's ratio and, by
/// the mean peak angle, c by tools/calibrate from the triaxial tests of Fukushima & Tatsuoka
/// (1984).
SandConstants toyoura() {
  SandConstants sand;
  sand.G0 = 125.0;
  sand.Mc = 1.25;
  sand.c = 0.656;
  sand.e_Gamma = 0.934;
  sand.lambda_c = 0.019;
  sand.xi = 0.7;
  sand.d0 = 0.478;
  sand.m = 6.67;
  sand.eps_r = 0.045;
  sand.Gs = 2.64;
  sand.e_max = 0.977;
  sand.e_min = 0.605;
  sand.d50 = 0.16e-3;
  sand.dilatancy = Dilatancy::lode;
  sand.bulk = BulkModulus::poisson;
  sand.poisson_ratio = 0.137;
  sand.gap_opening = bridges_break;
  return sand;
}

}  // namespace

std::span<const NamedSand> named_sands() {
  static const std::array<NamedSand, 3> sands{
      {{"stockton", "Stockton Beach sand, house reading", stockton()},
       {"stockton_paper", "Stockton Beach sand, Table 1 and the paper's equations as printed",
        stockton_paper()},
       {"toyoura", "Toyoura sand, calibrated on triaxial tests", toyoura()}}};
  return sands;
}

}  // namespace mpm::material
