#pragma once

#include <array>

#include "mpm/core/Simd.hpp"
#include "mpm/material/Material.hpp"

namespace mpm::material {

/// The symmetric tensors of four particles, components as those of SymmetricTensor.
struct PackTensor {
  std::array<simd::Pack, SymmetricTensor::size> components{};

  simd::Pack& operator[](int k) { return components[static_cast<std::size_t>(k)]; }
  const simd::Pack& operator[](int k) const { return components[static_cast<std::size_t>(k)]; }
};

/// `count` numbers, at most four of which fill a pack; the last one is repeated in lanes without.
inline simd::Pack load_lanes(const double* from, std::size_t count) {
  return simd::load(from, count < simd::lanes ? static_cast<int>(count) : simd::lanes);
}
inline void store_lanes(double* to, simd::Pack x, std::size_t count) {
  simd::store(to, x, count < simd::lanes ? static_cast<int>(count) : simd::lanes);
}

/// Of the particles from p on, `count` of which are left.
template <class Scalar>
PackTensor load_lanes(const TensorView<Scalar>& view, std::size_t p, std::size_t count) {
  PackTensor a;
  for (int k = 0; k < SymmetricTensor::size; ++k)
    if (const double* values = view.component[static_cast<std::size_t>(k)])
      a[k] = load_lanes(values + p, count);
  return a;
}
inline void store_lanes(const TensorView<double>& view, std::size_t p, std::size_t count,
                        const PackTensor& a) {
  for (int k = 0; k < SymmetricTensor::size; ++k)
    if (double* values = view.component[static_cast<std::size_t>(k)])
      store_lanes(values + p, a[k], count);
}

inline simd::Pack trace(const PackTensor& a) {
  return a[0] + a[1] + a[2];
}

/// a : b.
inline simd::Pack contract(const PackTensor& a, const PackTensor& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

}  // namespace mpm::material
