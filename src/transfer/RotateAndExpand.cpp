#include "mpm/core/Simd.hpp"
#include "mpm/transfer/Transfer.hpp"

namespace mpm::transfer {
namespace {

using simd::Pack;
using Matrix = std::array<std::array<Pack, 3>, 3>;

/// Hughes-Winget rotation of the spin w = (W_xy, W_yz, W_xz) dt: Q = 1 + (W + W^2/2)/(1 + w.w/4)
/// with W the skew matrix, the closed form of (1 - W/2)^-1 (1 + W/2).
Matrix rotation(Pack xy, Pack yz, Pack xz) {
  const Pack zero{};
  const Matrix W{{{zero, xy, xz}, {-xy, zero, yz}, {-xz, -yz, zero}}};
  const Pack factor = 1.0 / (1.0 + 0.25 * (xy * xy + yz * yz + xz * xz));
  Matrix Q;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      Pack square{};
      for (int k = 0; k < 3; ++k) square += W[i][k] * W[k][j];
      Q[i][j] = (i == j ? 1.0 : 0.0) + factor * (W[i][j] + 0.5 * square);
    }
  return Q;
}

/// Q s Q^T, components as in SymmetricTensor.
void rotate(const Matrix& Q, std::array<Pack, 6>& s) {
  const Matrix S{{{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}}};
  Matrix QS{}, R{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) QS[i][j] += Q[i][k] * S[k][j];
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      for (int k = 0; k < 3; ++k) R[i][j] += QS[i][k] * Q[j][k];
  s = {R[0][0], R[1][1], R[2][2], R[0][1], R[1][2], R[0][2]};
}

/// Rotation in the plane: c and s of the angle 2 atan(w/2), exact in the Cayley form.
void rotate_in_plane(Pack w, Pack& xx, Pack& yy, Pack& xy) {
  const Pack factor = 1.0 / (1.0 + 0.25 * w * w);
  const Pack c = (1.0 - 0.25 * w * w) * factor, s = w * factor;  // Q = [c s; -s c]
  const Pack a = xx, b = yy, t = xy;
  xx = c * c * a + 2.0 * c * s * t + s * s * b;
  yy = s * s * a - 2.0 * c * s * t + c * c * b;
  xy = c * s * (b - a) + (c * c - s * s) * t;
}

/// sqrt(2/3 e':e') with e' the deviator.
template <int dim>
Pack deviatoric_strain(const std::array<Pack, tensor_components<dim>>& e, Pack volumetric) {
  Pack square{};
  for (int k = 0; k < 3; ++k) {
    const Pack deviator = e[k] - volumetric / 3.0;
    square += deviator * deviator;
  }
  for (int k = 3; k < tensor_components<dim>; ++k) square += 2.0 * e[k] * e[k];
  return simd::sqrt(2.0 / 3.0 * square);
}

/// A <- (1 + L dt) A (1 + L dt)^T, what a material ellipsoid x.A^-1 x = 1 turns into.
template <int dim>
void deform_extents(const particles::ParticleView<dim>& particles, const Increments& increments,
                    int offset, int n) {
  const int first = increments.range.first + offset;
  const auto strain = [&](int k) { return simd::load(increments.strain[k].data() + offset, n); };
  const auto spin = [&](int k) { return simd::load(increments.spin[k].data() + offset, n); };
  Matrix F{}, A{};
  for (int d = 0; d < dim; ++d) F[d][d] = 1.0 + strain(d);
  const auto set_pair = [&](int i, int j, Pack e, Pack w) {
    F[i][j] = e + w;
    F[j][i] = e - w;
  };
  if constexpr (dim >= 2) set_pair(0, 1, strain(3), spin(0));
  if constexpr (dim == 3) {
    set_pair(1, 2, strain(4), spin(1));
    set_pair(0, 2, strain(5), spin(2));
  }
  const auto at = [&](int k) { return particles.extent[k] + first; };
  constexpr int index[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) A[i][j] = simd::load(at(index[i][j]), n);
  Matrix FA{};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j)
      for (int k = 0; k < dim; ++k) FA[i][j] += F[i][k] * A[k][j];
  for (int i = 0; i < dim; ++i)
    for (int j = i; j < dim; ++j) {
      Pack sum{};
      for (int k = 0; k < dim; ++k) sum += FA[i][k] * F[j][k];
      simd::store(at(index[i][j]), sum, n);
    }
}

}  // namespace

template <int dim>
void rotate_and_expand(const particles::ParticleView<dim>& particles,
                       const Increments& increments) {
  simd::for_each_group(increments.range.size(), [&](int offset, int n) {
    const int first = increments.range.first + offset;
    constexpr int components = tensor_components<dim>;
    std::array<Pack, components> e, s;
    for (int k = 0; k < components; ++k) {
      e[k] = simd::load(increments.strain[k].data() + offset, n);
      s[k] = simd::load(particles.stress[k] + first, n);
    }
    const auto spin = [&](int k) { return simd::load(increments.spin[k].data() + offset, n); };
    if constexpr (dim == 2) rotate_in_plane(spin(0), s[0], s[1], s[3]);
    if constexpr (dim == 3) rotate(rotation(spin(0), spin(1), spin(2)), s);
    if constexpr (dim > 1)
      for (int k = 0; k < components; ++k) simd::store(particles.stress[k] + first, s[k], n);

    if (particles.extent[0] != nullptr) deform_extents<dim>(particles, increments, offset, n);

    const Pack volumetric = e[0] + e[1] + e[2];
    double* const V = particles.volume + first;
    simd::store(V, simd::load(V, n) * simd::exp(volumetric), n);
    double* const accumulated = particles.deviatoric_strain + first;
    simd::store(accumulated, simd::load(accumulated, n) + deviatoric_strain<dim>(e, volumetric), n);
  });
}

template void rotate_and_expand<1>(const particles::ParticleView<1>&, const Increments&);
template void rotate_and_expand<2>(const particles::ParticleView<2>&, const Increments&);
template void rotate_and_expand<3>(const particles::ParticleView<3>&, const Increments&);

}  // namespace mpm::transfer
