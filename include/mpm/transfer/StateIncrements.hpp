#pragma once

#include <span>

#include "mpm/basis/BSpline.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/transfer/Stencil.hpp"

namespace mpm::transfer {

/// A state variable x of particles, its values x^0 some steps ago, and two nodal arrays: V_I and,
/// of its increment, first V_I dx_I and then the average dx_I.
struct AveragedState {
  double* x;
  const double* x_0;
  double* V_I;
  double* dx_I;
};

/// V_I += V_p N_Ip and V_I dx_I += V_p (x_p - x_p^0) N_Ip for a range of the particles. Adds to the
/// local arrays.
template <int dim>
void deposit_state_increments(const particles::ParticleView<dim>& particles,
                              const particles::Range& range,
                              Stencil<dim, basis::BSpline<3>> stencil,
                              std::span<const AveragedState> states);

/// x_p = x_p^0 + sum_I dx_I N_Ip for a range of the particles.
template <int dim>
void take_averaged_increments(const particles::ParticleView<dim>& particles,
                              const particles::Range& range,
                              Stencil<dim, basis::BSpline<3>> stencil,
                              std::span<const AveragedState> states);

}  // namespace mpm::transfer
