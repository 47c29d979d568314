#include "mpm/solver/StableCourant.hpp"

#include <array>

namespace mpm::solver {
namespace {

/// Limits of one basis: stress last from remapped velocities and stress first have the same.
struct Limits {
  std::array<double, 3> remapped_or_first;  ///< by transfer: flip, pic, apic
  std::array<double, 3> last;
};

/// Where a particle barely reaches a node, limits of bases with a kink there fall towards zero with
/// the reach; these hold down to a thousandth of a cell.
Limits limits_of(basis::Kind kind, basis::EndTreatment ends) {
  const bool open = ends == basis::EndTreatment::open_knot;
  switch (kind) {
    case basis::Kind::linear:
      return {{1.30, 1.15, 0.062}, {0.044, 0.044, 0.062}};
    case basis::Kind::gimp:
      return {{1.69, 1.48, 0.90}, {0.62, 0.63, 0.68}};
    case basis::Kind::ddmp:
      return {{1.50, 1.23, 0.062}, {0.044, 0.044, 0.062}};
    case basis::Kind::quadratic:
      return open ? Limits{{1.55, 1.31, 0.98}, {0.67, 0.69, 0.78}}
                  : Limits{{1.90, 1.87, 1.30}, {0.69, 0.70, 0.78}};
    case basis::Kind::cubic:
      return open ? Limits{{1.43, 1.20, 0.84}, {0.53, 0.54, 0.62}}
                  : Limits{{2.18, 1.90, 1.50}, {1.00, 1.00, 1.20}};
  }
  return {};  // not reached
}

}  // namespace

double stable_courant(const Method& method) {
  const Limits limits = limits_of(method.basis, method.ends);
  const auto transfer = static_cast<std::size_t>(method.transfer);
  return (method.scheme == Scheme::usl ? limits.last : limits.remapped_or_first)[transfer];
}

}  // namespace mpm::solver
