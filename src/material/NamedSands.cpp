#include "mpm/material/NamedSands.hpp"

#include <array>

namespace mpm::material {
namespace {

SandConstants stockton_paper() {
  return {};  // Table 1 is what SandConstants begins with
}

SandConstants stockton() {
  SandConstants sand = stockton_paper();
  sand.c = extension_ratio_of_equal_angles(sand.Mc);
  sand.dilatancy = Dilatancy::lode;
  return sand;
}

SandConstants toyoura() {
  SandConstants sand;
  sand.G0 = 125.0;
  sand.Mc = 1.25;
  sand.c = extension_ratio_of_equal_angles(sand.Mc);
  sand.e_Gamma = 0.934;
  sand.lambda_c = 0.019;
  sand.xi = 0.7;
  sand.Gs = 2.64;
  sand.e_max = 0.977;
  sand.e_min = 0.605;
  sand.d50 = 0.16e-3;
  sand.dilatancy = Dilatancy::lode;
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
