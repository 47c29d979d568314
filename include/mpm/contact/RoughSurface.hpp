#pragma once

#include "mpm/contact/Friction.hpp"

namespace mpm::contact {

/// Nothing slides while the surfaces touch: all of the relative velocity is removed.
template <int dim>
class RoughSurface : public FrictionLaw<dim> {
 public:
  explicit RoughSurface(const FrictionParameters&) {}
  Vector<dim> velocity_change(const Vector<dim>& relative, const Vector<dim>&) const override {
    Vector<dim> change;
    for (int d = 0; d < dim; ++d) change[d] = -relative[d];
    return change;
  }
};

}  // namespace mpm::contact
