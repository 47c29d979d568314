#include "mpm/particles/BoundaryParticles.hpp"

#include <fmt/format.h>

#include "mpm/core/Errors.hpp"

namespace mpm::particles {
namespace {

template <int dim>
std::vector<typename Swarm<dim>::Column> columns() {
  std::vector<typename Swarm<dim>::Column> columns{{"pressure", Swarm<dim>::Type::real}};
  for (const char* vector : {"anchor", "offset", "area"})
    for (int d = 0; d < dim; ++d)
      columns.push_back({fmt::format("{}_{}", vector, "xyz"[d]), Swarm<dim>::Type::real});
  return columns;
}

}  // namespace

template <int dim>
BoundaryView<dim>::BoundaryView(const Swarm<dim>& swarm)
    : count(swarm.local_count()), m_columns(swarm.dm()) {
  m_columns.open_vector("anchor", anchor);
  m_columns.open_vector("offset", offset);
  m_columns.open_vector("area", area);
  pressure = m_columns.reals("pressure");
}

template <int dim>
BoundaryParticles<dim>::BoundaryParticles(const grid::Grid<dim>& grid)
    : m_grid(grid), m_swarm(grid, "boundary particle", columns<dim>()) {}

template <int dim>
void BoundaryParticles<dim>::add(std::span<const SurfacePiece<dim>> pieces) {
  std::vector<SurfacePiece<dim>> mine;
  for (const SurfacePiece<dim>& piece : pieces) {
    const auto cell = m_grid.cell_of(piece.anchor);
    if (!m_grid.all_cells().contains(cell))
      throw BadInput(fmt::format("a loaded surface at ({:.6g}) m lies outside the grid: enlarge it",
                                 fmt::join(piece.anchor, ", ")));
    if (m_grid.owned_cells().contains(cell)) mine.push_back(piece);
  }
  int b = m_swarm.grow(static_cast<int>(mine.size()));
  const BoundaryView<dim> boundary = view();
  for (const SurfacePiece<dim>& piece : mine) {
    for (int d = 0; d < dim; ++d) {
      boundary.anchor[d][b] = piece.anchor[d];
      boundary.offset[d][b] = piece.offset[d];
      boundary.area[d][b] = piece.area[d];
    }
    boundary.pressure[b++] = piece.pressure;
  }
}

template <int dim>
void BoundaryParticles<dim>::migrate() {
  std::vector<std::array<int, dim>> cells;
  {
    const BoundaryView<dim> boundary = view();
    for (int b = 0; b < boundary.count; ++b) cells.push_back(m_grid.cell_of(boundary.anchor_of(b)));
  }
  m_swarm.migrate(cells);
}

template class BoundaryView<1>;
template class BoundaryView<2>;
template class BoundaryView<3>;
template class BoundaryParticles<1>;
template class BoundaryParticles<2>;
template class BoundaryParticles<3>;

}  // namespace mpm::particles
