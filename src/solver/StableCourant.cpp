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
      return {{0.88, 1.03, 0.062}, {0.044, 0.044, 0.062}};
    case basis::Kind::gimp:
      return {{1.56, 1.40, 0.69}, {0.46, 0.48, 0.49}};
    case basis::Kind::ddmp:
      return {{0.93, 1.13, 0.062}, {0.044, 0.044, 0.062}};
    case basis::Kind::quadratic:
      return open ? Limits{{1.28, 1.1, 0.8}, {0.59, 0.6, 0.7}}
                  : Limits{{1.97, 1.72, 1.00}, {0.59, 0.62, 0.74}};
    case basis::Kind::cubic:
      return open ? Limits{{1.07, 1.0, 0.7}, {0.47, 0.48, 0.5}}
                  : Limits{{2.18, 2.00, 1.43}, {0.94, 1.03, 1.24}};
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
