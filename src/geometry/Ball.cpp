#include "mpm/geometry/Ball.hpp"

#include <cmath>

namespace mpm::geometry {

template <int dim>
Proximity<dim> Ball<dim>::locate(const Vector<dim>& x) const {
  Vector<dim> r;
  double square = 0.0;
  for (int d = 0; d < dim; ++d) {
    r[d] = x[d] - m_centre[d];
    square += r[d] * r[d];
  }
  const double length = std::sqrt(square);
  Proximity<dim> result{length - m_radius, {}};
  if (length == 0.0) result.normal[dim - 1] = 1.0;
  for (int d = 0; d < dim && length > 0.0; ++d) result.normal[d] = r[d] / length;
  return result;
}

template <int dim>
std::vector<double> Ball<dim>::crossings(const Vector<dim>& x, const Vector<dim>& along) const {
  double middle = 0.0, square = m_radius * m_radius;
  for (int d = 0; d < dim; ++d) middle += (m_centre[d] - x[d]) * along[d];
  for (int d = 0; d < dim; ++d) {
    const double across = m_centre[d] - x[d] - middle * along[d];
    square -= across * across;
  }
  if (square <= 0.0) return {};
  return {middle - std::sqrt(square), middle + std::sqrt(square)};
}

template <int dim>
std::unique_ptr<Shape<dim>> Ball<dim>::moved(const Vector<dim>& by) const {
  Vector<dim> centre = m_centre;
  for (int d = 0; d < dim; ++d) centre[d] += by[d];
  return std::make_unique<Ball>(m_radius, centre);
}

template class Ball<1>;
template class Ball<2>;
template class Ball<3>;

}  // namespace mpm::geometry
