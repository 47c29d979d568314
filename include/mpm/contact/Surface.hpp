#pragma once

#include <cmath>

#include "mpm/core/Tensor.hpp"

namespace mpm::contact {

/// Where a point lies relative to a rigid surface.
template <int dim>
struct Proximity {
  double distance;     ///< m, negative inside; changes by no more than the way between two points
  Vector<dim> normal;  ///< unit, out of the rigid body
};

/// The shape of a rigid body about its own reference point.
template <int dim>
class Surface {
 public:
  virtual ~Surface() = default;
  virtual Proximity<dim> locate(const Vector<dim>& from_reference) const = 0;
};

/// A circle (2D) or sphere (3D) about the reference point.
template <int dim>
class Ball : public Surface<dim> {
 public:
  explicit Ball(double radius) : m_radius(radius) {}
  Proximity<dim> locate(const Vector<dim>& r) const override {
    double square = 0.0;
    for (double component : r) square += component * component;
    const double length = std::sqrt(square);
    Proximity<dim> result{length - m_radius, {}};
    if (length == 0.0) result.normal[dim - 1] = 1.0;
    for (int d = 0; d < dim && length > 0.0; ++d) result.normal[d] = r[d] / length;
    return result;
  }

 private:
  double m_radius;
};

/// The half space behind a plane through the reference point.
template <int dim>
class HalfSpace : public Surface<dim> {
 public:
  explicit HalfSpace(const Vector<dim>& unit_normal) : m_normal(unit_normal) {}
  Proximity<dim> locate(const Vector<dim>& r) const override {
    double distance = 0.0;
    for (int d = 0; d < dim; ++d) distance += r[d] * m_normal[d];
    return {distance, m_normal};
  }

 private:
  Vector<dim> m_normal;
};

}  // namespace mpm::contact
