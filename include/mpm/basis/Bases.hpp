#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mpm/basis/BSpline.hpp"
#include "mpm/basis/Ddmp.hpp"
#include "mpm/basis/Gimp.hpp"

/// The one table of bases a run can choose from: word of the option, type. A new basis is a type
/// with the members of BSpline and one line here.
#define MPM_BASES(X)       \
  X(linear, BSpline<1>)    \
  X(gimp, Gimp)            \
  X(ddmp, Ddmp)            \
  X(quadratic, BSpline<2>) \
  X(cubic, BSpline<3>)

/// MPM_BASES(MPM_IN_ALL_DIMENSIONS) expands MPM_INSTANTIATE(dim, Basis), which the source defines
/// before, for every basis in one to three dimensions.
#define MPM_IN_ALL_DIMENSIONS(name, Basis) \
  MPM_INSTANTIATE(1, basis::Basis)         \
  MPM_INSTANTIATE(2, basis::Basis)         \
  MPM_INSTANTIATE(3, basis::Basis)

namespace mpm::basis {

#define MPM_NAME_OF_BASIS(name, Basis) name,
enum class Kind { MPM_BASES(MPM_NAME_OF_BASIS) };
#undef MPM_NAME_OF_BASIS

#define MPM_WORD_OF_BASIS(name, Basis) {#name, Kind::name},
inline std::vector<std::pair<std::string, Kind>> kinds() {
  return {MPM_BASES(MPM_WORD_OF_BASIS)};
}
#undef MPM_WORD_OF_BASIS

/// What the bases of a run are made of besides the lines; each takes what concerns it.
struct BasisOptions {
  EndTreatment ends = EndTreatment::mirror;
  int particles_per_cell = 2;  ///< per direction
};

template <class Basis>
Basis make_basis(const KnotLines& lines, const BasisOptions& options) {
  if constexpr (std::is_constructible_v<Basis, KnotLines, EndTreatment>)
    return Basis(lines, options.ends);
  else if constexpr (std::is_constructible_v<Basis, KnotLines, int>)
    return Basis(lines, options.particles_per_cell);
  else
    return Basis(lines);
}

/// visit.template operator()<Basis>() for the basis of this kind.
template <class Visit>
auto with_basis(Kind kind, const Visit& visit) {
  switch (kind) {
#define MPM_CASE_OF_BASIS(name, Basis) \
  case Kind::name:                     \
    return visit.template operator()<Basis>();
    MPM_BASES(MPM_CASE_OF_BASIS)
#undef MPM_CASE_OF_BASIS
  }
  return visit.template operator()<BSpline<3>>();  // not reached
}

}  // namespace mpm::basis
