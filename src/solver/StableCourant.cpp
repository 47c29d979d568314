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
      return {{0.884, 1.036, 0.062}, {0.044, 0.044, 0.062}};
    case basis::Kind::gimp:
      return {{1.567, 1.405, 0.698}, {0.460, 0.488, 0.498}};
    case basis::Kind::ddmp:
      return {{0.934, 1.131, 0.062}, {0.044, 0.044, 0.062}};
    case basis::Kind::quadratic:
      return open ? Limits{{1.283, 1.191, 0.913}, {0.591, 0.626, 0.735}}
                  : Limits{{1.970, 1.723, 1.002}, {0.591, 0.626, 0.746}};
    case basis::Kind::cubic:
      return open ? Limits{{1.075, 0.986, 0.772}, {0.473, 0.507, 0.579}}
                  : Limits{{2.182, 2.006, 1.433}, {0.945, 1.035, 1.243}};
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
