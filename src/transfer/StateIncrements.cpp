#include "mpm/transfer/StateIncrements.hpp"

#include "mpm/core/Simd.hpp"

namespace mpm::transfer {
namespace {

using simd::Pack;

void add(double* to, Pack x) {
  simd::store(to, simd::load(to) + x);
}

}  // namespace

template <int dim>
void deposit_state_increments(const particles::ParticleView<dim>& particles,
                              const particles::Range& range,
                              Stencil<dim, basis::BSpline<3>> stencil,
                              std::span<const AveragedState> states) {
  for (int p = range.first; p < range.last; ++p) {
    const double V_p = particles.volume[p];
    stencil.move_to(particles.position_of(p));
    for (const AveragedState& state : states) {
      const double V_dx = V_p * (state.x[p] - state.x_0[p]);
      stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
        add(state.V_I + I, V_p * N);
        add(state.dx_I + I, V_dx * N);
      });
    }
  }
}

template <int dim>
void take_averaged_increments(const particles::ParticleView<dim>& particles,
                              const particles::Range& range,
                              Stencil<dim, basis::BSpline<3>> stencil,
                              std::span<const AveragedState> states) {
  for (int p = range.first; p < range.last; ++p) {
    stencil.move_to(particles.position_of(p));
    for (const AveragedState& state : states) {
      Pack dx{};
      stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
        dx += simd::load(state.dx_I + I) * N;
      });
      state.x[p] = state.x_0[p] + simd::sum(dx);
    }
  }
}

#define MPM_INSTANTIATE(dim)                                            \
  template void deposit_state_increments<dim>(                          \
      const particles::ParticleView<dim>&, const particles::Range&,     \
      Stencil<dim, basis::BSpline<3>>, std::span<const AveragedState>); \
  template void take_averaged_increments<dim>(                          \
      const particles::ParticleView<dim>&, const particles::Range&,     \
      Stencil<dim, basis::BSpline<3>>, std::span<const AveragedState>);
MPM_INSTANTIATE(1)
MPM_INSTANTIATE(2)
MPM_INSTANTIATE(3)

}  // namespace mpm::transfer
