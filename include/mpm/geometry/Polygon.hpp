#pragma once

#include "mpm/geometry/Shape.hpp"

namespace mpm::geometry {

/// A polygon in the plane, its corners in either sense of rotation.
class Polygon : public Shape<2> {
 public:
  /// Throws BadInput unless there are three corners or more whose sides do not cross.
  explicit Polygon(std::vector<Vector<2>> corners);

  Proximity<2> locate(const Vector<2>& x) const override;
  std::vector<double> crossings(const Vector<2>& x, const Vector<2>& along) const override;
  /// The centroid of its area.
  Vector<2> reference() const override;
  std::unique_ptr<Shape<2>> moved(const Vector<2>& by) const override;

 private:
  struct Side {
    Vector<2> begin, end;
  };
  Side side(std::size_t k) const { return {m_corners[k], m_corners[(k + 1) % m_corners.size()]}; }
  bool holds(const Vector<2>& x) const;
  void check_sides() const;

  std::vector<Vector<2>> m_corners;  ///< anticlockwise
};

}  // namespace mpm::geometry
