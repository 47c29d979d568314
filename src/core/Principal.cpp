#include "mpm/core/Principal.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace mpm {
namespace {

constexpr int largest_number_of_sweeps = 20;  // convergence is quadratic, five are many

/// A diagonal with the off-diagonal component opposite to each index, and the axes in columns.
struct Rotated {
  std::array<double, 3> diagonal;
  std::array<double, 3> opposite;
  std::array<Vector<3>, 3> axis{{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
};

/// Turns in the plane of the two axes other than k, so that their shear component vanishes.
void rotate(Rotated& a, std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  const double shear = a.opposite[k];
  const double cotangent = 0.5 * (a.diagonal[j] - a.diagonal[i]) / shear;  // of twice the angle
  const double t = std::copysign(1.0, cotangent) /
                   (std::abs(cotangent) + std::sqrt(cotangent * cotangent + 1.0));
  const double c = 1.0 / std::sqrt(t * t + 1.0), s = t * c;
  a.diagonal[i] -= t * shear;
  a.diagonal[j] += t * shear;
  a.opposite[k] = 0.0;
  const double ki = a.opposite[j], kj = a.opposite[i];  // components k-i and k-j
  a.opposite[j] = c * ki - s * kj;
  a.opposite[i] = s * ki + c * kj;
  for (std::size_t d = 0; d < 3; ++d) {
    const double along_i = a.axis[i][d], along_j = a.axis[j][d];
    a.axis[i][d] = c * along_i - s * along_j;
    a.axis[j][d] = s * along_i + c * along_j;
  }
}

void order(Principal& p, std::size_t i, std::size_t j) {
  if (!(p.value[i] < p.value[j])) return;
  std::swap(p.value[i], p.value[j]);
  std::swap(p.axis[i], p.axis[j]);
}

}  // namespace

Principal principal(const SymmetricTensor& a) {
  Rotated rotated{{a[0], a[1], a[2]}, {a[4], a[5], a[3]}};
  const double negligible = std::numeric_limits<double>::epsilon() * 0.1 * norm(a);
  for (int sweep = 0; sweep < largest_number_of_sweeps; ++sweep) {
    bool is_diagonal = true;
    for (std::size_t k : {2U, 0U, 1U}) {
      if (!(std::abs(rotated.opposite[k]) > negligible)) continue;
      rotate(rotated, k);
      is_diagonal = false;
    }
    if (is_diagonal) break;
  }
  Principal p{rotated.diagonal, rotated.axis};
  order(p, 0, 1);
  order(p, 1, 2);
  order(p, 0, 1);
  return p;
}

SymmetricTensor compose(const Principal& p) {
  SymmetricTensor a;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto& [x, y, z] = p.axis[k];
    a += p.value[k] * SymmetricTensor{{x * x, y * y, z * z, x * y, y * z, x * z}};
  }
  return a;
}

}  // namespace mpm
