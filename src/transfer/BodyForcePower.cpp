#include "mpm/basis/Bases.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/transfer/Transfer.hpp"

namespace mpm::transfer {

using simd::Pack;

template <int dim, class Basis>
double body_force_power(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                        const ParticleBodyForce<dim>& body_force, double dt,
                        const VelocityAcceleration<dim>& nodes) {
  double power = 0.0;
  for (int p = 0; p < particles.count; ++p) {
    const Vector<dim> b = body_force[p];
    Pack sum{};
    stencil.move_to(particles.position_of(p));
    stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
      for (int d = 0; d < dim; ++d)
        sum +=
            b[d] * N *
            (simd::load(nodes.velocity[d] + I) - 0.5 * dt * simd::load(nodes.acceleration[d] + I));
    });
    power += particles.mass[p] * simd::sum(sum);
  }
  return power;
}

#define MPM_INSTANTIATE(dim, Basis)                                                                \
  template double body_force_power<dim, Basis>(const particles::ParticleView<dim>&,                \
                                               Stencil<dim, Basis>, const ParticleBodyForce<dim>&, \
                                               double, const VelocityAcceleration<dim>&);
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::transfer
