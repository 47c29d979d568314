#pragma once

#include "mpm/geometry/Shape.hpp"

namespace mpm::geometry {

/// All that lies behind a plane.
template <int dim>
class HalfSpace : public Shape<dim> {
 public:
  explicit HalfSpace(const Vector<dim>& unit_normal, const Vector<dim>& point = {})
      : m_normal(unit_normal), m_point(point) {}

  Proximity<dim> locate(const Vector<dim>& x) const override;
  std::vector<double> crossings(const Vector<dim>& x, const Vector<dim>& along) const override;
  Vector<dim> reference() const override { return m_point; }
  std::unique_ptr<Shape<dim>> moved(const Vector<dim>& by) const override;

 private:
  Vector<dim> m_normal;
  Vector<dim> m_point;
};

extern template class HalfSpace<1>;
extern template class HalfSpace<2>;
extern template class HalfSpace<3>;

}  // namespace mpm::geometry
