#pragma once

#include "mpm/core/Simd.hpp"
#include "mpm/material/PackTensor.hpp"

namespace mpm::material {

/// What the sand law asks of a stress deviator, and of the strain deviator e that changes it.
struct Deviator {
  simd::Pack square;  ///< deviator : deviator
  simd::Pack along;   ///< deviator : e
  simd::Pack det;     ///< determinant
  simd::Pack turn;    ///< derivative of the determinant along e
  simd::Mask exact;   ///< nothing has cancelled
};

/// The old stress deviator s and the strain deviator e of four particles. Every deviator on the way
/// through a step is a s + b e, and so seven numbers do for any number of components.
struct DeviatorPlane {
  simd::Pack s_s, s_e, e_e;                 ///< s : s and so on
  simd::Pack det_s, turn_s, turn_e, det_e;  ///< det s, cof(s) : e, cof(e) : s, det e

  Deviator start() const { return {s_s, s_e, det_s, turn_s, s_s > 0.0}; }

  /// Of a s + b e. Exact to 1e-13 where at least a tenth of the two is left of their sum.
  Deviator at(simd::Pack a, simd::Pack b) const {
    constexpr double least_left = 1e-2;  // squared
    const simd::Pack aa = a * a, ab2 = 2.0 * (a * b), bb = b * b;
    const simd::Pack of_s = aa * s_s, of_e = bb * e_e;
    const simd::Pack square = of_s + ab2 * s_e + of_e;
    return {square, a * s_e + b * e_e,
            aa * (a * det_s + b * turn_s) + bb * (a * turn_e + b * det_e),
            aa * turn_s + ab2 * turn_e + 3.0 * bb * det_e, square > least_left * (of_s + of_e)};
  }

  /// Square of the size of a s + b e, without the care that at() takes.
  simd::Pack square_of(simd::Pack a, simd::Pack b) const {
    return a * (a * s_s + 2.0 * b * s_e) + b * b * e_e;
  }
};

/// Whether the components yz and xz, which are then zero, need no looking at.
enum class Shear { in_plane, any };

inline simd::Pack contract(const PackTensor& a, const PackTensor& b, Shear shear) {
  simd::Pack sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3]);
  if (shear == Shear::any) sum += 2.0 * (a[4] * b[4] + a[5] * b[5]);
  return sum;
}

inline PackTensor cofactor(const PackTensor& a, Shear shear) {
  PackTensor cof;
  cof[0] = a[1] * a[2];
  cof[1] = a[0] * a[2];
  cof[2] = a[0] * a[1] - a[3] * a[3];
  cof[3] = -a[3] * a[2];
  if (shear == Shear::in_plane) return cof;
  cof[0] -= a[4] * a[4];
  cof[1] -= a[5] * a[5];
  cof[3] += a[4] * a[5];
  cof[4] = a[3] * a[5] - a[4] * a[0];
  cof[5] = a[3] * a[4] - a[1] * a[5];
  return cof;
}

/// Along the first row.
inline simd::Pack determinant(const PackTensor& a, const PackTensor& cof, Shear shear) {
  const simd::Pack det = a[0] * cof[0] + a[3] * cof[3];
  return shear == Shear::any ? det + a[5] * cof[5] : det;
}

inline DeviatorPlane plane_of(const PackTensor& s, const PackTensor& e, Shear shear) {
  const PackTensor cof_s = cofactor(s, shear), cof_e = cofactor(e, shear);
  return {contract(s, s, shear),        contract(s, e, shear),     contract(e, e, shear),
          determinant(s, cof_s, shear), contract(cof_s, e, shear), contract(cof_e, s, shear),
          determinant(e, cof_e, shear)};
}

}  // namespace mpm::material
