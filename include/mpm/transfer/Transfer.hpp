#pragma once

#include <array>
#include <vector>

#include "mpm/core/Tensor.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/transfer/BodyForce.hpp"
#include "mpm/transfer/Stencil.hpp"

namespace mpm::transfer {

/// Slices of a nodal field read as mass, momentum and force.
template <int dim>
struct MassMomentumForce {
  explicit MassMomentumForce(grid::NodalField<dim>& field) : mass(field.values(0)) {
    for (int d = 0; d < dim; ++d) {
      momentum[d] = field.values(1 + d);
      force[d] = field.values(1 + dim + d);
    }
  }
  static std::vector<grid::Component> components();

  double* mass;
  std::array<double*, dim> momentum, force;
};

/// Slices of a nodal field read as velocity and acceleration.
template <int dim>
struct VelocityAcceleration {
  explicit VelocityAcceleration(grid::NodalField<dim>& field) {
    for (int d = 0; d < dim; ++d) {
      velocity[d] = field.values(d);
      acceleration[d] = field.values(dim + d);
    }
  }
  static std::vector<grid::Component> components();

  std::array<double*, dim> velocity, acceleration;
};

/// Slices of a nodal field read as one vector.
template <int dim>
struct NodalVector {
  NodalVector(const std::array<double*, dim>& components) : value(components) {}
  explicit NodalVector(grid::NodalField<dim>& field) {
    for (int d = 0; d < dim; ++d) value[d] = field.values(d);
  }
  static std::vector<grid::Component> components();

  std::array<double*, dim> value;
};

/// D dt per particle (tension positive) and the entries of the spin W dt: W_xy, W_yz, W_xz. Number
/// 0 is the first particle of the range.
struct Increments {
  particles::Range range;
  std::array<std::vector<double>, SymmetricTensor::size> strain;
  std::array<std::vector<double>, 3> spin;

  /// Makes room for these particles.
  void cover(const particles::Range& particles, int dim);
};

/// What a sweep found out about particles that moved too far.
struct Drift {
  bool must_migrate = false;  ///< one has left the cells this rank can carry
  int lost = -1;              ///< one that has left the grid or has no finite position, or -1
};

/// Deposits m_I, p_I and f_I = f_int + f_ext of this rank's particles (Eqs. 1-5, body force b).
/// Adds to the local arrays; ghosts are to be summed afterwards.
template <int dim, class Basis>
void deposit_mass_momentum_force(const particles::ParticleView<dim>& particles,
                                 Stencil<dim, Basis> stencil,
                                 const ParticleBodyForce<dim>& body_force,
                                 MassMomentumForce<dim> nodes);

/// Sum of m_p b_p . v_I N_Ip with the nodes' velocities of the middle of a step, v_I - a_I dt/2, W:
/// what the body force that these particles have deposited does. Reads ghosts. Local.
template <int dim, class Basis>
double body_force_power(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                        const ParticleBodyForce<dim>& body_force, double dt,
                        const VelocityAcceleration<dim>& nodes);

/// Deposits m_p N_Ip alone, on which dual bases depend. Ghosts are to be summed afterwards.
template <int dim, class Basis>
void deposit_mass(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                  double* mass);

/// v_p += sum a_I N_Ip dt (Eq. 7), then p_I += m_p v_p N_Ip from the new velocities (Eq. 9). A
/// share 1 - `flip_share` of v_p is replaced by the grid's sum v_I N_Ip (PIC), which lets motion
/// die out that the grid cannot see. Reads ghosts of both.
template <int dim, class Basis>
void update_velocities_and_deposit_momentum(const particles::ParticleView<dim>& particles,
                                            Stencil<dim, Basis> stencil, double dt,
                                            double flip_share, VelocityAcceleration<dim> nodes,
                                            NodalVector<dim> momentum);

/// v_p += sum a_I N_Ip dt (Eq. 7) alone.
template <int dim, class Basis>
void update_velocities(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                       double dt, double flip_share, VelocityAcceleration<dim> nodes);

/// p_I += m_p C_p N_Ip (x_I - x_p), what particles that carry a velocity gradient C deposit besides
/// m_p v_p N_Ip (APIC; Jiang et al. 2015, ACM Trans. Graph. 34:51). Ghosts are to be summed
/// afterwards.
template <int dim, class Basis>
void deposit_affine_momentum(const particles::ParticleView<dim>& particles,
                             Stencil<dim, Basis> stencil, std::array<double*, dim> momentum);

/// C_p = sum v_I N_Ip (x_I - x_p) D_p^-1 with D_p = sum N_Ip (x_I - x_p)(x_I - x_p), which is
/// diagonal because directions separate. Reads ghosts of `velocity`.
template <int dim, class Basis>
void gather_velocity_gradient(const particles::ParticleView<dim>& particles,
                              Stencil<dim, Basis> stencil, std::array<double*, dim> velocity);

/// Times over which particles are strained and moved, s: the same but where stress comes first.
struct AdvanceTimes {
  double strain;
  double move;
};

/// Strain and spin increments from `strain_velocity`, then x_p += sum v_I N_Ip dt from that of
/// `nodes` (Eq. 8), for a range of the particles. Both use the weights of the old position. Reads
/// ghosts of both.
template <int dim, class Basis>
Drift gather_increments_and_move(const particles::ParticleView<dim>& particles,
                                 const particles::Range& range, Stencil<dim, Basis> stencil,
                                 const AdvanceTimes& dt, VelocityAcceleration<dim> nodes,
                                 NodalVector<dim> strain_velocity, const grid::Grid<dim>& grid,
                                 Increments& increments);

/// Deposits V_p N_I and V_p tr(D dt) N_I of all particles. Ghosts are to be summed afterwards.
template <int dim, class Basis>
void deposit_volume_change(const particles::ParticleView<dim>& particles,
                           Stencil<dim, Basis> stencil, const Increments& increments,
                           double* volume, double* change);

/// tr(D dt) <- share sum theta_I N_I + (1 - share) tr(D dt) of every particle, all of which are
/// covered, keeping the deviator. Reads ghosts of `change`, theta_I.
template <int dim, class Basis>
void blend_volume_change(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                         const double* change, double share, Increments& increments);

/// sigma <- Q sigma Q^T with Q = (1 - W dt/2)^-1 (1 + W dt/2) (Hughes and Winget), which keeps
/// the norm of the stress; V <- V exp(tr D dt); accumulates sqrt(2/3 e:e). For the particles that
/// the increments cover.
template <int dim>
void rotate_and_expand(const particles::ParticleView<dim>& particles, const Increments& increments);

}  // namespace mpm::transfer
