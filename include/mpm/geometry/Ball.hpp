#pragma once

#include "mpm/geometry/Shape.hpp"

namespace mpm::geometry {

/// A circle (2D) or sphere (3D).
template <int dim>
class Ball : public Shape<dim> {
 public:
  explicit Ball(double radius, const Vector<dim>& centre = {})
      : m_radius(radius), m_centre(centre) {}

  Proximity<dim> locate(const Vector<dim>& x) const override;
  std::vector<double> crossings(const Vector<dim>& x, const Vector<dim>& along) const override;
  Vector<dim> reference() const override { return m_centre; }
  std::unique_ptr<Shape<dim>> moved(const Vector<dim>& by) const override;

 private:
  double m_radius;
  Vector<dim> m_centre;
};

extern template class Ball<1>;
extern template class Ball<2>;
extern template class Ball<3>;

}  // namespace mpm::geometry
