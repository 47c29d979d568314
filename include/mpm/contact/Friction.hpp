#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "mpm/core/Tensor.hpp"

namespace mpm::contact {

/// How two touching surfaces hold each other.
template <int dim>
class FrictionLaw {
 public:
  virtual ~FrictionLaw() = default;
  /// The change of a node's velocity where it closes in on the other surface with the velocity
  /// `relative`, m/s; `normal` is that surface's outward unit normal.
  virtual Vector<dim> velocity_change(const Vector<dim>& relative,
                                      const Vector<dim>& normal) const = 0;
};

/// What friction laws are made from.
struct FrictionParameters {
  double coefficient = 0.0;  ///< Coulomb's mu
};

struct FrictionKind {
  std::string_view name;
  std::string_view sentence;
  std::unique_ptr<FrictionLaw<1>> (*make_1d)(const FrictionParameters&);
  std::unique_ptr<FrictionLaw<2>> (*make_2d)(const FrictionParameters&);
  std::unique_ptr<FrictionLaw<3>> (*make_3d)(const FrictionParameters&);
};

/// The one table of friction laws: a new one is one file and one line here.
std::span<const FrictionKind> friction_kinds();

/// The law of row k of the table.
template <int dim>
std::unique_ptr<FrictionLaw<dim>> make_friction(std::size_t k,
                                                const FrictionParameters& parameters) {
  const FrictionKind& kind = friction_kinds()[k];
  if constexpr (dim == 1) return kind.make_1d(parameters);
  if constexpr (dim == 2) return kind.make_2d(parameters);
  if constexpr (dim == 3) return kind.make_3d(parameters);
}

}  // namespace mpm::contact
