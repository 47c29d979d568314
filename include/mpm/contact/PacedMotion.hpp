#pragma once

#include "mpm/contact/Motion.hpp"

namespace mpm::contact {

/// Along a line, with a speed that somebody sets as the run goes.
template <int dim>
class PacedMotion : public Motion<dim> {
 public:
  explicit PacedMotion(const Vector<dim>& unit_direction) : m_direction(unit_direction) {}

  double speed = 0.0;  ///< m/s

  BodyVelocity<dim> at(double) const override {
    BodyVelocity<dim> velocity;
    for (int d = 0; d < dim; ++d) velocity.translation[d] = m_direction[d] * speed;
    return velocity;
  }

 private:
  Vector<dim> m_direction;
};

}  // namespace mpm::contact
