#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/core/Tensor.hpp"

namespace mpm::cases::custom {

inline constexpr std::array<const char*, 6> side_names{"left", "right", "bottom",
                                                       "top",  "front", "back"};

/// Throws BadInput, which says how many an option needs, unless it has `count` numbers.
inline void need_numbers(const std::string& option, const std::vector<double>& list,
                         std::size_t count) {
  if (list.size() != count)
    throw BadInput(fmt::format("-{} {}: {} numbers are given and {} needed with this -dimension",
                               option, fmt::join(list, ","), list.size(), count));
}

template <int dim>
Vector<dim> vector_from(const std::vector<double>& list, std::size_t first = 0) {
  Vector<dim> v;
  for (std::size_t d = 0; d < dim; ++d) v[d] = list[first + d];
  return v;
}

/// Lower and upper corner.
template <int dim>
struct Corners {
  Vector<dim> lower, upper;

  bool hold(const Vector<dim>& x) const {
    for (int d = 0; d < dim; ++d)
      if (x[d] < lower[d] || x[d] > upper[d]) return false;
    return true;
  }
};

/// Throws BadInput unless the lower one is below the upper one.
template <int dim>
Corners<dim> corners_from(const std::string& option, const std::vector<double>& list) {
  need_numbers(option, list, 2 * dim);
  const Corners<dim> corners{vector_from<dim>(list), vector_from<dim>(list, dim)};
  for (int d = 0; d < dim; ++d)
    if (!(corners.lower[d] < corners.upper[d]))
      throw BadInput(
          fmt::format("-{} {}: the lower corner, which comes first, is not below the "
                      "upper one: {} and {}",
                      option, fmt::join(list, ","), corners.lower[d], corners.upper[d]));
  return corners;
}

}  // namespace mpm::cases::custom
