#include "mpm/geometry/ShapeKinds.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "mpm/core/Errors.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/geometry/Box.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/geometry/Polygon.hpp"

namespace mpm::geometry {
namespace {

using Numbers = std::span<const double>;

void need(Numbers numbers, std::size_t count) {
  if (numbers.size() != count)
    throw BadInput(fmt::format("{} numbers are given and {} needed", numbers.size(), count));
}

template <int dim>
Vector<dim> vector_from(Numbers numbers, std::size_t first) {
  Vector<dim> v;
  for (std::size_t d = 0; d < dim; ++d) v[d] = numbers[first + d];
  return v;
}

template <int dim>
std::unique_ptr<Shape<dim>> box(Numbers numbers) {
  need(numbers, 2 * dim);
  const auto lower = vector_from<dim>(numbers, 0), upper = vector_from<dim>(numbers, dim);
  for (int d = 0; d < dim; ++d)
    if (!(lower[d] < upper[d]))
      throw BadInput(fmt::format("its lower corner is not below its upper one: {} and {}", lower[d],
                                 upper[d]));
  return std::make_unique<Box<dim>>(lower, upper);
}

template <int dim>
std::unique_ptr<Shape<dim>> ball(Numbers numbers) {
  need(numbers, dim + 1);
  const double radius = numbers[dim];
  if (!(radius > 0.0)) throw BadInput(fmt::format("its radius {} is not positive", radius));
  return std::make_unique<Ball<dim>>(radius, vector_from<dim>(numbers, 0));
}

std::unique_ptr<Shape<2>> polygon(Numbers numbers) {
  if (numbers.size() % 2 != 0)
    throw BadInput(fmt::format("{} numbers are no pairs", numbers.size()));
  std::vector<Vector<2>> corners;
  for (std::size_t k = 0; k < numbers.size(); k += 2) corners.push_back(vector_from<2>(numbers, k));
  return std::make_unique<Polygon>(std::move(corners));
}

template <int dim>
std::unique_ptr<Shape<dim>> layer(Numbers numbers) {
  need(numbers, 2);
  if (!(numbers[0] < numbers[1]))
    throw BadInput(
        fmt::format("its lower side {} is not below its upper one {}", numbers[0], numbers[1]));
  Vector<dim> lower, upper;
  lower.fill(-std::numeric_limits<double>::infinity());
  upper.fill(std::numeric_limits<double>::infinity());
  lower[vertical<dim>] = numbers[0];
  upper[vertical<dim>] = numbers[1];
  return std::make_unique<Box<dim>>(lower, upper);
}

template <int dim>
std::unique_ptr<Shape<dim>> plane(Numbers numbers) {
  need(numbers, 2 * dim);
  Vector<dim> normal = vector_from<dim>(numbers, dim);
  double square = 0.0;
  for (const double component : normal) square += component * component;
  if (!(square > 0.0)) throw BadInput("its normal has no length");
  for (double& component : normal) component /= std::sqrt(square);
  return std::make_unique<HalfSpace<dim>>(normal, vector_from<dim>(numbers, 0));
}

constexpr std::array kinds{
    ShapeKind{"box", "lower and upper corner: x0,y0,x1,y1", &box<1>, &box<2>, &box<3>},
    ShapeKind{"ball", "middle and radius: x,y,r", &ball<1>, &ball<2>, &ball<3>},
    ShapeKind{"polygon", "corners in order: x,y,x,y,x,y,...", nullptr, &polygon, nullptr},
    ShapeKind{"layer", "everything between two heights: y0,y1", &layer<1>, &layer<2>, &layer<3>},
    ShapeKind{"plane", "a point of it and the normal that points out: x,y,nx,ny", &plane<1>,
              &plane<2>, &plane<3>},
};

template <int dim>
auto maker_of(const ShapeKind& kind) {
  if constexpr (dim == 1) return kind.make_1d;
  if constexpr (dim == 2) return kind.make_2d;
  if constexpr (dim == 3) return kind.make_3d;
}

}  // namespace

std::span<const ShapeKind> shape_kinds() {
  return kinds;
}

template <int dim>
std::unique_ptr<Shape<dim>> make_shape(std::size_t k, Numbers numbers) {
  const auto make = maker_of<dim>(kinds.at(k));
  if (make == nullptr) throw BadInput(fmt::format("there is none in {} dimensions", dim));
  return make(numbers);
}

template std::unique_ptr<Shape<1>> make_shape<1>(std::size_t, Numbers);
template std::unique_ptr<Shape<2>> make_shape<2>(std::size_t, Numbers);
template std::unique_ptr<Shape<3>> make_shape<3>(std::size_t, Numbers);

}  // namespace mpm::geometry
