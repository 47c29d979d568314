#pragma once

#include "mpm/contact/Friction.hpp"

namespace mpm::contact {

/// The closing part of the relative velocity is removed and the sliding part reduced by at most mu
/// times it (Bardenhagen et al. 2000).
template <int dim>
class CoulombFriction : public FrictionLaw<dim> {
 public:
  explicit CoulombFriction(const FrictionParameters& parameters)
      : m_coefficient(parameters.coefficient) {}
  Vector<dim> velocity_change(const Vector<dim>& relative,
                              const Vector<dim>& normal) const override;

 private:
  double m_coefficient;
};

}  // namespace mpm::contact
