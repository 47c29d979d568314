#include "mpm/contact/CoulombFriction.hpp"

#include <cmath>

namespace mpm::contact {
namespace {

template <int dim>
double dot(const Vector<dim>& a, const Vector<dim>& b) {
  double sum = 0.0;
  for (int d = 0; d < dim; ++d) sum += a[d] * b[d];
  return sum;
}

}  // namespace

template <int dim>
Vector<dim> CoulombFriction<dim>::velocity_change(const Vector<dim>& relative,
                                                  const Vector<dim>& normal) const {
  const double closing = -dot<dim>(relative, normal);
  Vector<dim> sliding, change;
  for (int d = 0; d < dim; ++d) sliding[d] = relative[d] + closing * normal[d];
  const double speed = std::sqrt(dot<dim>(sliding, sliding));
  const double held = m_coefficient * closing;
  const double share = speed > held ? held / speed : 1.0;
  for (int d = 0; d < dim; ++d) change[d] = closing * normal[d] - share * sliding[d];
  return change;
}

template class CoulombFriction<1>;
template class CoulombFriction<2>;
template class CoulombFriction<3>;

}  // namespace mpm::contact
