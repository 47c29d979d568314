#pragma once

#include <array>

#include "mpm/core/Tensor.hpp"

namespace mpm {

/// Principal values of a symmetric tensor, largest first, and their unit axes.
struct Principal {
  std::array<double, 3> value;
  std::array<Vector<3>, 3> axis;  ///< orthonormal, also where values repeat
};

/// By Jacobi rotations: exact to round-off of the largest value whatever repeats or vanishes. One
/// rotation suffices in plane strain, whose yz and xz are zero and stay exactly so.
Principal principal(const SymmetricTensor& a);

/// The tensor sum_i value_i axis_i axis_i.
SymmetricTensor compose(const Principal& p);

}  // namespace mpm
