#include "mpm/geometry/HalfSpace.hpp"

namespace mpm::geometry {

template <int dim>
Proximity<dim> HalfSpace<dim>::locate(const Vector<dim>& x) const {
  double distance = 0.0;
  for (int d = 0; d < dim; ++d) distance += (x[d] - m_point[d]) * m_normal[d];
  return {distance, m_normal};
}

template <int dim>
std::vector<double> HalfSpace<dim>::crossings(const Vector<dim>& x,
                                              const Vector<dim>& along) const {
  double slope = 0.0;
  for (int d = 0; d < dim; ++d) slope += along[d] * m_normal[d];
  if (slope == 0.0) return {};
  return {-locate(x).distance / slope};
}

template <int dim>
std::unique_ptr<Shape<dim>> HalfSpace<dim>::moved(const Vector<dim>& by) const {
  Vector<dim> point = m_point;
  for (int d = 0; d < dim; ++d) point[d] += by[d];
  return std::make_unique<HalfSpace>(m_normal, point);
}

template class HalfSpace<1>;
template class HalfSpace<2>;
template class HalfSpace<3>;

}  // namespace mpm::geometry
