#pragma once

#include <span>

#include "mpm/particles/Swarm.hpp"

namespace mpm::particles {

/// A piece of a body's surface.
template <int dim>
struct SurfacePiece {
  Vector<dim> anchor;  ///< position of the particle behind the piece, m
  Vector<dim> offset;  ///< from there to the middle of the piece, m
  Vector<dim> area;    ///< outward normal times area, m^2 per unit of the dimensions left out
  double pressure;     ///< Pa, positive where it presses on the body
};

/// Pointers into the arrays of boundary particles.
template <int dim>
class BoundaryView {
 public:
  explicit BoundaryView(const Swarm<dim>& swarm);

  int count;
  std::array<double*, dim> anchor;
  std::array<double*, dim> offset;
  std::array<double*, dim> area;
  double* pressure;

  Vector<dim> anchor_of(int b) const { return gather(anchor, b); }
  Vector<dim> offset_of(int b) const { return gather(offset, b); }
  Vector<dim> position_of(int b) const {
    Vector<dim> x = anchor_of(b);
    for (int d = 0; d < dim; ++d) x[d] += offset[d][b];
    return x;
  }
  Vector<dim> area_of(int b) const { return gather(area, b); }

 private:
  static Vector<dim> gather(const std::array<double*, dim>& columns, int b) {
    Vector<dim> value;
    for (int d = 0; d < dim; ++d) value[d] = columns[d][b];
    return value;
  }

  OpenColumns m_columns;
};

/// Massless points on the surface of a body that carry a pressure on it (Eq. 4) and move with it.
/// Each stands for a piece of the surface. Its anchor starts on the particle behind the piece and
/// moves as that particle does, so the two stay together; offset and area vector follow the
/// deformation there, dr = L r dt and Nanson's formula, so the pressure stays normal to the
/// deformed surface and acts on its present area. (Points that follow the grid's velocity on the
/// surface itself creep away from the body: nodes there have hardly any mass.) A point belongs to
/// the rank of its anchor's cell and may itself lie beyond the grid.
template <int dim>
class BoundaryParticles {
 public:
  /// Collective. `grid` must outlive the particles.
  explicit BoundaryParticles(const grid::Grid<dim>& grid);

  /// Adds the pieces that belong to this rank; all ranks give all pieces. Throws BadInput if an
  /// anchor lies outside the grid. Collective.
  void add(std::span<const SurfacePiece<dim>> pieces);

  void migrate();

  /// See Swarm.
  template <class Visit>
  void for_each_column(const Visit& visit) const {
    m_swarm.for_each_column(visit);
  }
  void replace(int count) { m_swarm.replace(count); }
  BoundaryView<dim> view() const { return BoundaryView<dim>(m_swarm); }
  int local_count() const { return m_swarm.local_count(); }
  long long global_count() const { return m_swarm.global_count(); }
  bool is_empty() const { return m_swarm.global_count() == 0; }

 private:
  const grid::Grid<dim>& m_grid;
  Swarm<dim> m_swarm;
};

extern template class BoundaryView<1>;
extern template class BoundaryView<2>;
extern template class BoundaryView<3>;
extern template class BoundaryParticles<1>;
extern template class BoundaryParticles<2>;
extern template class BoundaryParticles<3>;

}  // namespace mpm::particles
