#include "mpm/transfer/SurfaceLoad.hpp"

#include "mpm/basis/Bases.hpp"

namespace mpm::transfer {
namespace {

template <int dim>
using Gradient = std::array<Vector<dim>, dim>;  // L[i][j] = dv_i/dx_j

template <int dim>
Vector<dim> offset_rate(const Gradient<dim>& L, const Vector<dim>& r) {
  Vector<dim> rate{};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) rate[i] += L[i][j] * r[j];
  return rate;
}

/// (tr L - L^T) a, Nanson's formula as a rate.
template <int dim>
Vector<dim> area_rate(const Gradient<dim>& L, const Vector<dim>& a) {
  Vector<dim> rate{};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) rate[i] += L[j][j] * a[i] - L[j][i] * a[j];
  return rate;
}

/// Follows a linear rate of change over dt to second order.
template <int dim, class Rate>
Vector<dim> followed(const Gradient<dim>& L, Vector<dim> value, double dt, const Rate& rate_of) {
  const Vector<dim> rate = rate_of(L, value), second_rate = rate_of(L, rate);
  for (int d = 0; d < dim; ++d) value[d] += dt * (rate[d] + 0.5 * dt * second_rate[d]);
  return value;
}

}  // namespace

template <int dim, class Basis>
Vector<dim> deposit_surface_load(const particles::BoundaryView<dim>& boundary,
                                 Stencil<dim, Basis> stencil, const MassMomentumForce<dim>& nodes) {
  Vector<dim> sum{};
  for (int b = 0; b < boundary.count; ++b) {
    const Vector<dim> a = boundary.area_of(b);
    const double p = boundary.pressure[b];
    double share = 0.0;
    stencil.move_to_continued(boundary.anchor_of(b), boundary.position_of(b));
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>&) {
      for (int d = 0; d < dim; ++d) nodes.force[d][I] -= p * a[d] * N;
      share += N;
    });
    for (int d = 0; d < dim; ++d) sum[d] -= p * a[d] * share;
  }
  return sum;
}

template <int dim, class Basis>
double surface_load_power(const particles::BoundaryView<dim>& boundary, Stencil<dim, Basis> stencil,
                          double dt, const VelocityAcceleration<dim>& nodes) {
  double power = 0.0;
  for (int b = 0; b < boundary.count; ++b) {
    const Vector<dim> a = boundary.area_of(b);
    const double p = boundary.pressure[b];
    stencil.move_to_continued(boundary.anchor_of(b), boundary.position_of(b));
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>&) {
      for (int d = 0; d < dim; ++d)
        power -= p * a[d] * N * (nodes.velocity[d][I] - 0.5 * dt * nodes.acceleration[d][I]);
    });
  }
  return power;
}

template <int dim, class Basis>
Drift move_surface(const particles::BoundaryView<dim>& boundary, const grid::Grid<dim>& grid,
                   Stencil<dim, Basis> stencil, double dt, const VelocityAcceleration<dim>& nodes,
                   const NodalVector<dim>& remapped_velocity) {
  Drift drift;
  for (int b = 0; b < boundary.count; ++b) {
    Vector<dim> y = boundary.anchor_of(b), v{};
    Gradient<dim> L{};
    stencil.move_to(y);
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>& gradient) {
      for (int i = 0; i < dim; ++i) {
        v[i] += nodes.velocity[i][I] * N;
        for (int j = 0; j < dim; ++j) L[i][j] += remapped_velocity.value[i][I] * gradient[j];
      }
    });
    const Vector<dim> r = followed<dim>(L, boundary.offset_of(b), dt, offset_rate<dim>);
    const Vector<dim> a = followed<dim>(L, boundary.area_of(b), dt, area_rate<dim>);
    for (int d = 0; d < dim; ++d) {
      y[d] += v[d] * dt;
      boundary.anchor[d][b] = y[d];
      boundary.offset[d][b] = r[d];
      boundary.area[d][b] = a[d];
    }
    const auto cell = grid.cell_of(y);
    if (!grid.active_cells().contains(cell)) drift.must_migrate = true;
    if (!grid.all_cells().contains(cell)) drift.lost = b;
  }
  return drift;
}

#define MPM_INSTANTIATE(dim, Basis)                                                             \
  template Vector<dim> deposit_surface_load<dim, Basis>(                                        \
      const particles::BoundaryView<dim>&, Stencil<dim, Basis>, const MassMomentumForce<dim>&); \
  template double surface_load_power<dim, Basis>(const particles::BoundaryView<dim>&,           \
                                                 Stencil<dim, Basis>, double,                   \
                                                 const VelocityAcceleration<dim>&);             \
  template Drift move_surface<dim, Basis>(                                                      \
      const particles::BoundaryView<dim>&, const grid::Grid<dim>&, Stencil<dim, Basis>, double, \
      const VelocityAcceleration<dim>&, const NodalVector<dim>&);
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::transfer
