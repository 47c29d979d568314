#include "mpm/grid/Walls.hpp"

#include <cstddef>

namespace mpm::grid {
namespace {

/// The owned nodes with index `layer` in direction d; empty if they are another rank's.
template <int dim>
Box<dim> owned_layer(const Grid<dim>& grid, int d, int layer) {
  Box<dim> box = grid.owned_nodes();
  const bool owned = layer >= box.begin[d] && layer < box.end[d];
  box.begin[d] = layer;
  box.end[d] = owned ? layer + 1 : layer;
  return box;
}

/// Index distance in local arrays between neighbours in direction d.
template <int dim>
std::ptrdiff_t stride(const Grid<dim>& grid, int d) {
  std::ptrdiff_t product = 1;
  for (int k = 0; k < d; ++k) product *= grid.ghosted_nodes().extent(k);
  return product;
}

/// Layer a counted from the wall of this side, as a node index.
template <int dim>
int layer_of(const Grid<dim>& grid, int d, int side, int a) {
  return side == 0 ? a : grid.nodes(d).count() - 1 - a;
}

}  // namespace

template <int dim>
bool Walls<dim>::is_held(int d, int side, Component component) const {
  if (component.direction == Component::scalar) return false;
  return m_kinds[d][side] == Wall::fixed || component.direction == d;
}

template <int dim>
template <class Visit>
void Walls<dim>::for_each_wall(const Visit& visit) const {
  for (int d = 0; d < dim; ++d)
    for (int side : {0, 1})
      if (m_kinds[d][side] != Wall::free) visit(d, side);
}

template <int dim>
template <class Visit>
void Walls<dim>::for_each_pair(const Grid<dim>& grid, NodalField<dim>& field,
                               const Visit& visit) const {
  for_each_wall([&](int d, int side) {
    const basis::NodeLine& nodes = grid.nodes(d);
    for (int a = 0; nodes.mirrored && a < nodes.reflected(a); ++a) {
      const int layer = layer_of(grid, d, side, a);
      const int twin = layer_of(grid, d, side, nodes.reflected(a));
      const std::ptrdiff_t jump = (twin - layer) * stride(grid, d);
      for (int c = 0; c < field.components(); ++c) {
        double* values = field.values(c);
        const double sign = is_held(d, side, field.component(c)) ? -1.0 : 1.0;
        grid.for_each_node(owned_layer(grid, d, layer), [&](int local, const auto&) {
          visit(values[local], values[local + jump], sign);
        });
      }
    }
  });
}

template <int dim>
void Walls<dim>::fold(const Grid<dim>& grid, NodalField<dim>& field) const {
  for_each_pair(grid, field, [](double& beyond, double& reflection, double sign) {
    reflection += sign * beyond;
    beyond = 0.0;
  });
  hold(grid, field);
}

template <int dim>
void Walls<dim>::unfold(const Grid<dim>& grid, NodalField<dim>& field) const {
  for_each_pair(grid, field, [](double& beyond, const double& reflection, double sign) {
    beyond = sign * reflection;
  });
}

template <int dim>
void Walls<dim>::hold(const Grid<dim>& grid, NodalField<dim>& field) const {
  for_each_wall([&](int d, int side) {
    const basis::NodeLine& nodes = grid.nodes(d);
    const int at_wall = nodes.mirrored ? (nodes.support - 2) / 2 : 0;
    // Mirrored splines of even order have no node on the wall itself.
    if (nodes.mirrored && nodes.reflected(at_wall) != at_wall) return;
    for (int c = 0; c < field.components(); ++c) {
      if (!is_held(d, side, field.component(c))) continue;
      double* values = field.values(c);
      grid.for_each_node(owned_layer(grid, d, layer_of(grid, d, side, at_wall)),
                         [&](int local, const auto&) { values[local] = 0.0; });
    }
  });
}

template class Walls<1>;
template class Walls<2>;
template class Walls<3>;

}  // namespace mpm::grid
