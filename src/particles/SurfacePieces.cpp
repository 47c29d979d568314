#include "mpm/particles/SurfacePieces.hpp"

namespace mpm::particles {
namespace {

/// A particle's share of its cell, a direction.
template <int dim>
Vector<dim> extent_of(const std::array<basis::KnotLines, dim>& lines,
                      const std::array<int, dim>& cell, const Filling<dim>& filling) {
  Vector<dim> centre, extent;
  for (int d = 0; d < dim; ++d)
    centre[d] = 0.5 * (lines[d].line(cell[d]) + lines[d].line(cell[d] + 1));
  for (int d = 0; d < dim; ++d) extent[d] = lines[d].width(cell[d]) / filling.per_direction(centre);
  return extent;
}

template <int dim>
SurfacePiece<dim> piece_beside(const Vector<dim>& anchor, const Vector<dim>& extent, Side side) {
  const int d = side / 2;
  const double outward = side % 2 == 0 ? -1.0 : 1.0;
  double area = 1.0;
  for (int k = 0; k < dim; ++k)
    if (k != d) area *= extent[k];
  SurfacePiece<dim> piece{.anchor = anchor, .offset = {}, .area = {}, .pressure = 0.0};
  piece.offset[d] = outward * 0.5 * extent[d];
  piece.area[d] = outward * area;
  return piece;
}

template <int dim>
Vector<dim> sum(Vector<dim> a, const Vector<dim>& b, double factor) {
  for (int d = 0; d < dim; ++d) a[d] += factor * b[d];
  return a;
}

/// All cells, the first direction fastest.
template <int dim>
bool advance(std::array<int, dim>& cell, const std::array<basis::KnotLines, dim>& lines) {
  for (int d = 0; d < dim; ++d) {
    if (++cell[d] < lines[d].cells()) return true;
    cell[d] = 0;
  }
  return false;
}

}  // namespace

template <int dim>
std::vector<SurfacePiece<dim>> surface_pieces(
    const std::array<basis::KnotLines, dim>& lines, const Filling<dim>& filling, Side side,
    const std::function<double(const Vector<dim>&)>& pressure) {
  std::vector<SurfacePiece<dim>> pieces;
  std::array<int, dim> cell{};
  do {
    const Vector<dim> extent = extent_of<dim>(lines, cell, filling);
    for (const Seed<dim>& seed : seeds_of_cell<dim>(lines, cell, filling)) {
      SurfacePiece<dim> piece = piece_beside<dim>(seed.position, extent, side);
      if (filling.material_at(sum<dim>(seed.position, piece.offset, 2.0))) continue;
      piece.pressure = pressure(sum<dim>(seed.position, piece.offset, 1.0));
      if (piece.pressure != 0.0) pieces.push_back(piece);
    }
  } while (advance<dim>(cell, lines));
  return pieces;
}

#define MPM_INSTANTIATE(dim)                                               \
  template std::vector<SurfacePiece<dim>> surface_pieces<dim>(             \
      const std::array<basis::KnotLines, dim>&, const Filling<dim>&, Side, \
      const std::function<double(const Vector<dim>&)>&)
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::particles
