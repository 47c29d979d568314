#pragma once

#include <memory>
#include <vector>

#include "mpm/core/Tensor.hpp"

namespace mpm::geometry {

/// The direction against which gravity acts: y, or x where there is no other.
template <int dim>
inline constexpr int vertical = dim == 1 ? 0 : 1;

/// The unit vector of that direction.
template <int dim>
constexpr Vector<dim> upward() {
  Vector<dim> up{};
  up[vertical<dim>] = 1.0;
  return up;
}

/// Where a point lies relative to the surface of a shape.
template <int dim>
struct Proximity {
  double distance;     ///< m, negative inside; changes by no more than the way between two points
  Vector<dim> normal;  ///< unit, out of the shape
};

/// A part of space: what a region of soil fills, or what a rigid body is.
template <int dim>
class Shape {
 public:
  virtual ~Shape() = default;
  virtual Proximity<dim> locate(const Vector<dim>& x) const = 0;
  /// Distances from x along the unit vector `along`, and against it where negative, at which the
  /// line through x crosses the surface, in any order, m.
  virtual std::vector<double> crossings(const Vector<dim>& x, const Vector<dim>& along) const = 0;
  /// The point by which people place it: its middle, or a point of a plane, m.
  virtual Vector<dim> reference() const = 0;
  virtual std::unique_ptr<Shape> moved(const Vector<dim>& by) const = 0;
};

}  // namespace mpm::geometry
