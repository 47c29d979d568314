#pragma once

#include "mpm/particles/BoundaryParticles.hpp"
#include "mpm/transfer/Transfer.hpp"

namespace mpm::transfer {

/// f_I -= p a N_I at every boundary particle: the second sum of Eq. 4 with the traction -p n on
/// the area a = n S. The functions are those of the anchor's cell, continued to the surface, since
/// nodes of an empty cell beyond have no mass. Adds to the local arrays; ghosts are to be summed
/// afterwards. Returns the sum of what it has added, N: continued functions of some bases do not
/// quite sum to 1.
template <int dim, class Basis>
Vector<dim> deposit_surface_load(const particles::BoundaryView<dim>& boundary,
                                 Stencil<dim, Basis> stencil, const MassMomentumForce<dim>& nodes);

/// Sum of -p a . v over the boundary particles, with the mean velocity v = v_I - a_I dt/2 of the
/// step gathered as the load was deposited, W. Reads ghosts.
template <int dim, class Basis>
double surface_load_power(const particles::BoundaryView<dim>& boundary, Stencil<dim, Basis> stencil,
                          double dt, const VelocityAcceleration<dim>& nodes);

/// Moves boundary particles with the body: anchors by sum v_I N_I dt as particles move, offsets by
/// dr/dt = L r and area vectors by da/dt = (tr L - L^T) a, to second order, with L at the anchor.
/// Reads ghosts of both fields.
template <int dim, class Basis>
Drift move_surface(const particles::BoundaryView<dim>& boundary, const grid::Grid<dim>& grid,
                   Stencil<dim, Basis> stencil, double dt, const VelocityAcceleration<dim>& nodes,
                   const NodalVector<dim>& remapped_velocity);

}  // namespace mpm::transfer
