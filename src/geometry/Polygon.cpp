#include "mpm/geometry/Polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mpm/core/Errors.hpp"

namespace mpm::geometry {
namespace {

double cross(const Vector<2>& a, const Vector<2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

double dot(const Vector<2>& a, const Vector<2>& b) {
  return a[0] * b[0] + a[1] * b[1];
}

Vector<2> difference(const Vector<2>& a, const Vector<2>& b) {
  return {a[0] - b[0], a[1] - b[1]};
}

/// Twice the area, positive where the corners go anticlockwise.
double twice_area(const std::vector<Vector<2>>& corners) {
  double sum = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k)
    sum += cross(corners[k], corners[(k + 1) % corners.size()]);
  return sum;
}

Vector<2> nearest_on(const Vector<2>& begin, const Vector<2>& end, const Vector<2>& x) {
  const Vector<2> along = difference(end, begin), from = difference(x, begin);
  const double square = along[0] * along[0] + along[1] * along[1];
  const double share = std::clamp(dot(from, along) / square, 0.0, 1.0);
  return {begin[0] + share * along[0], begin[1] + share * along[1]};
}

/// Whether a and b lie on different sides of the line through c and d.
bool parts(const Vector<2>& c, const Vector<2>& d, const Vector<2>& a, const Vector<2>& b) {
  const Vector<2> line = difference(d, c);
  return cross(line, difference(a, c)) * cross(line, difference(b, c)) < 0.0;
}

}  // namespace

Polygon::Polygon(std::vector<Vector<2>> corners) : m_corners(std::move(corners)) {
  if (m_corners.size() < 3)
    throw BadInput(fmt::format("a polygon of {} corners; three are needed", m_corners.size()));
  const double area = twice_area(m_corners);
  if (area == 0.0) throw BadInput("a polygon without area");
  check_sides();
  if (area < 0.0) std::ranges::reverse(m_corners);
}

void Polygon::check_sides() const {
  for (std::size_t k = 0; k < m_corners.size(); ++k)
    for (std::size_t l = 0; l < k; ++l) {
      const auto [a, b] = side(k);
      const auto [c, d] = side(l);
      if (parts(a, b, c, d) && parts(c, d, a, b))
        throw BadInput(fmt::format("a polygon whose sides {} and {} cross", l + 1, k + 1));
    }
}

/// The surface lies to the left of the sides: where x is on one, its normal is the side's.
Proximity<2> Polygon::locate(const Vector<2>& x) const {
  Proximity<2> best{std::numeric_limits<double>::infinity(), {}};
  for (std::size_t k = 0; k < m_corners.size(); ++k) {
    const auto [begin, end] = side(k);
    const Vector<2> away = difference(x, nearest_on(begin, end, x));
    const double distance = std::hypot(away[0], away[1]);
    if (distance >= best.distance) continue;
    const Vector<2> along = difference(end, begin);
    const double length = std::hypot(along[0], along[1]);
    best = {distance, {along[1] / length, -along[0] / length}};
    if (distance > 1e-12 * length) best.normal = {away[0] / distance, away[1] / distance};
  }
  if (!holds(x)) return best;
  const bool on_side = best.distance == 0.0;
  return {-best.distance, on_side ? best.normal : Vector<2>{-best.normal[0], -best.normal[1]}};
}

bool Polygon::holds(const Vector<2>& x) const {
  bool inside = false;
  for (const double height : crossings(x, {0.0, 1.0}))
    if (height > 0.0) inside = !inside;
  return inside;
}

std::vector<double> Polygon::crossings(const Vector<2>& x, const Vector<2>& along) const {
  std::vector<double> distances;
  for (std::size_t k = 0; k < m_corners.size(); ++k) {
    const auto [begin, end] = side(k);
    const Vector<2> to_begin = difference(begin, x), to_end = difference(end, x);
    const double left = cross(along, to_begin), right = cross(along, to_end);
    if ((left >= 0.0) == (right >= 0.0)) continue;
    const double share = left / (left - right), first = dot(along, to_begin);
    distances.push_back(first + share * (dot(along, to_end) - first));
  }
  return distances;
}

Vector<2> Polygon::reference() const {
  Vector<2> sum{};
  for (std::size_t k = 0; k < m_corners.size(); ++k) {
    const auto [a, b] = side(k);
    const double weight = cross(a, b);
    for (int d = 0; d < 2; ++d) sum[d] += weight * (a[d] + b[d]);
  }
  const double three_areas = 3.0 * twice_area(m_corners);
  return {sum[0] / three_areas, sum[1] / three_areas};
}

std::unique_ptr<Shape<2>> Polygon::moved(const Vector<2>& by) const {
  std::vector<Vector<2>> corners = m_corners;
  for (Vector<2>& corner : corners)
    for (int d = 0; d < 2; ++d) corner[d] += by[d];
  return std::make_unique<Polygon>(std::move(corners));
}

}  // namespace mpm::geometry
