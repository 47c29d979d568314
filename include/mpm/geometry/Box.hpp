#pragma once

#include "mpm/geometry/Shape.hpp"

namespace mpm::geometry {

/// A rectangle (2D) or cuboid (3D) along the axes; sides may lie at infinity.
template <int dim>
class Box : public Shape<dim> {
 public:
  Box(const Vector<dim>& lower, const Vector<dim>& upper) : m_lower(lower), m_upper(upper) {}

  Proximity<dim> locate(const Vector<dim>& x) const override;
  std::vector<double> crossings(const Vector<dim>& x, const Vector<dim>& along) const override;
  Vector<dim> reference() const override;
  std::unique_ptr<Shape<dim>> moved(const Vector<dim>& by) const override;

 private:
  Vector<dim> m_lower, m_upper;
};

extern template class Box<1>;
extern template class Box<2>;
extern template class Box<3>;

}  // namespace mpm::geometry
