#include "mpm/geometry/Box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm::geometry {

/// Outside of an edge or corner the nearest point lies on it, so normals fan out there.
template <int dim>
Proximity<dim> Box<dim>::locate(const Vector<dim>& x) const {
  Vector<dim> beyond{};
  double square = 0.0;
  Proximity<dim> inside{-std::numeric_limits<double>::infinity(), {}};
  for (int d = 0; d < dim; ++d) {
    const double below = m_lower[d] - x[d], above = x[d] - m_upper[d];
    const double nearest = std::max(below, above);
    if (nearest > 0.0) beyond[d] = below > above ? -below : above;
    square += beyond[d] * beyond[d];
    if (nearest <= inside.distance) continue;
    inside = {nearest, {}};
    inside.normal[d] = below > above ? -1.0 : 1.0;
  }
  if (square == 0.0) return inside;
  const double distance = std::sqrt(square);
  for (double& component : beyond) component /= distance;
  return {distance, beyond};
}

template <int dim>
std::vector<double> Box<dim>::crossings(const Vector<dim>& x, const Vector<dim>& along) const {
  double begin = -std::numeric_limits<double>::infinity(), end = -begin;
  for (int d = 0; d < dim; ++d) {
    if (along[d] == 0.0) {
      if (x[d] < m_lower[d] || x[d] > m_upper[d]) return {};
      continue;
    }
    const double lower = (m_lower[d] - x[d]) / along[d], upper = (m_upper[d] - x[d]) / along[d];
    begin = std::max(begin, std::min(lower, upper));
    end = std::min(end, std::max(lower, upper));
  }
  if (begin > end) return {};
  return {begin, end};
}

template <int dim>
Vector<dim> Box<dim>::reference() const {
  Vector<dim> middle{};
  for (int d = 0; d < dim; ++d)
    if (std::isfinite(m_lower[d]) && std::isfinite(m_upper[d]))
      middle[d] = 0.5 * (m_lower[d] + m_upper[d]);
  return middle;
}

template <int dim>
std::unique_ptr<Shape<dim>> Box<dim>::moved(const Vector<dim>& by) const {
  Vector<dim> lower = m_lower, upper = m_upper;
  for (int d = 0; d < dim; ++d) {
    lower[d] += by[d];
    upper[d] += by[d];
  }
  return std::make_unique<Box>(lower, upper);
}

template class Box<1>;
template class Box<2>;
template class Box<3>;

}  // namespace mpm::geometry
