#include "mpm/grid/Walls.hpp"

#include <cstddef>

namespace mpm::grid {
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
      const int layers = (side == 0 ? 1 : -1) * (nodes.reflected(a) - a);
      const std::ptrdiff_t jump = layers * grid.ghosted_nodes().stride(d);
      for (int c = 0; c < field.components(); ++c) {
        double* values = field.values(c);
        const double sign = is_held(d, side, field.component(c)) ? -1.0 : 1.0;
        for (int local : grid.end_layer(d, side, a))
          visit(values[local], values[local + jump], sign);
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
      for (int local : grid.end_layer(d, side, at_wall)) values[local] = 0.0;
    }
  });
}

template class Walls<1>;
template class Walls<2>;
template class Walls<3>;

}  // namespace mpm::grid
