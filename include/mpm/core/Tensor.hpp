#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace mpm {

template <int dim>
using Vector = std::array<double, dim>;

/// A symmetric second-order tensor in three dimensions, components xx, yy, zz, xy, yz, xz
/// (tensor components, not engineering shear strains).
struct SymmetricTensor {
  static constexpr int size = 6;
  std::array<double, size> components{};

  double& operator[](int k) { return components[static_cast<std::size_t>(k)]; }
  double operator[](int k) const { return components[static_cast<std::size_t>(k)]; }

  SymmetricTensor& operator+=(const SymmetricTensor& other) {
    for (int k = 0; k < size; ++k) (*this)[k] += other[k];
    return *this;
  }
  SymmetricTensor& operator*=(double factor) {
    for (double& component : components) component *= factor;
    return *this;
  }
};

inline SymmetricTensor operator+(SymmetricTensor a, const SymmetricTensor& b) {
  return a += b;
}
inline SymmetricTensor operator*(double factor, SymmetricTensor a) {
  return a *= factor;
}

inline double trace(const SymmetricTensor& a) {
  return a[0] + a[1] + a[2];
}

/// a : b = a_ij b_ij.
inline double contract(const SymmetricTensor& a, const SymmetricTensor& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

inline double norm(const SymmetricTensor& a) {
  return std::sqrt(contract(a, a));
}

inline double determinant(const SymmetricTensor& a) {
  return a[0] * (a[1] * a[2] - a[4] * a[4]) - a[3] * (a[3] * a[2] - a[4] * a[5]) +
         a[5] * (a[3] * a[4] - a[1] * a[5]);
}

inline SymmetricTensor deviator(SymmetricTensor a) {
  const double mean = trace(a) / 3.0;
  for (int k = 0; k < 3; ++k) a[k] -= mean;
  return a;
}

/// Number of tensor components that a particle of this dimension carries. The normal ones are
/// always there (plane strain has a stress out of plane); the list is a leading part of
/// xx, yy, zz, xy, yz, xz.
template <int dim>
inline constexpr int tensor_components = dim == 1 ? 3 : (dim == 2 ? 4 : 6);

}  // namespace mpm
