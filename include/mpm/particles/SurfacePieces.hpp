#pragma once

#include <functional>
#include <vector>

#include "mpm/particles/BoundaryParticles.hpp"
#include "mpm/particles/Seeding.hpp"

namespace mpm::particles {

/// A side that faces an end of a direction: 2 d, or 2 d + 1 for the upper end.
using Side = int;

/// The pieces of the surface of what fills the grid that face this side, one beside each particle
/// that has none of the filling one particle further on, where `pressure` is not 0 at their middle.
template <int dim>
std::vector<SurfacePiece<dim>> surface_pieces(
    const std::array<basis::KnotLines, dim>& lines, const Filling<dim>& filling, Side side,
    const std::function<double(const Vector<dim>&)>& pressure);

}  // namespace mpm::particles
