#pragma once

#include <span>
#include <string_view>

#include "mpm/geometry/Shape.hpp"

namespace mpm::geometry {

/// A kind of shape that can be written as numbers.
struct ShapeKind {
  std::string_view name;
  std::string_view sentence;  ///< what the numbers are
  /// Throw BadInput where the numbers make no such shape; null where the dimension has none.
  std::unique_ptr<Shape<1>> (*make_1d)(std::span<const double>);
  std::unique_ptr<Shape<2>> (*make_2d)(std::span<const double>);
  std::unique_ptr<Shape<3>> (*make_3d)(std::span<const double>);
};

/// The one table of shapes: a new one is one file and one line here.
std::span<const ShapeKind> shape_kinds();

/// The shape of row k of the table. Throws BadInput, which says what numbers it takes.
template <int dim>
std::unique_ptr<Shape<dim>> make_shape(std::size_t k, std::span<const double> numbers);

}  // namespace mpm::geometry
