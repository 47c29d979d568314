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

/// Walls are folded one after another, so what a wall takes away holds what those before it have
/// put there.
template <int dim>
std::vector<typename Walls<dim>::Held> Walls<dim>::fold_sums(const Grid<dim>& grid,
                                                             NodalField<dim>& sums) const {
  std::vector<Held> held;
  for_each_wall([&](int d, int side) {
    const basis::NodeLine& nodes = grid.nodes(d);
    for (int a = 0; nodes.mirrored && a < nodes.reflected(a); ++a) {
      const int layers = (side == 0 ? 1 : -1) * (nodes.reflected(a) - a);
      const auto jump = static_cast<int>(layers * grid.ghosted_nodes().stride(d));
      for (int local : grid.end_layer(d, side, a)) {
        for (int c = 0; c < dim; ++c)
          if (is_held(d, side, {c}))
            held.push_back({2 * d + side, c, local + jump, sums.values(0)[local],
                            sums.values(1 + c)[local], sums.values(1 + dim + c)[local]});
        fold_node(sums, d, side, local, local + jump);
      }
    }
  });
  const std::vector<Held> on_walls = about_to_hold(grid, sums);
  held.insert(held.end(), on_walls.begin(), on_walls.end());
  hold(grid, sums);
  return held;
}

template <int dim>
void Walls<dim>::fold_node(NodalField<dim>& field, int d, int side, int beyond,
                           int reflection) const {
  for (int c = 0; c < field.components(); ++c) {
    double* values = field.values(c);
    const double sign = is_held(d, side, field.component(c)) ? -1.0 : 1.0;
    values[reflection] += sign * values[beyond];
    values[beyond] = 0.0;
  }
}

template <int dim>
template <class Visit>
void Walls<dim>::for_each_held_node(const Grid<dim>& grid, const Visit& visit) const {
  for_each_wall([&](int d, int side) {
    const basis::NodeLine& nodes = grid.nodes(d);
    const int at_wall = nodes.mirrored ? (nodes.support - 2) / 2 : 0;
    if (nodes.mirrored && nodes.reflected(at_wall) != at_wall) return;
    for (int local : grid.end_layer(d, side, at_wall)) visit(d, side, local);
  });
}

template <int dim>
std::vector<typename Walls<dim>::Held> Walls<dim>::about_to_hold(const Grid<dim>& grid,
                                                                 NodalField<dim>& sums) const {
  std::vector<Held> held;
  std::vector<char> is_taken(static_cast<std::size_t>(dim * grid.local_size()), 0);
  for_each_held_node(grid, [&](int d, int side, int local) {
    for (int c = 0; c < dim; ++c) {
      if (sums.values(0)[local] == 0.0 && sums.values(1 + dim + c)[local] == 0.0) continue;
      char& taken = is_taken[static_cast<std::size_t>(dim * local + c)];
      if (!is_held(d, side, {c}) || taken != 0) continue;
      taken = 1;
      held.push_back({2 * d + side, c, -1, sums.values(0)[local], sums.values(1 + c)[local],
                      sums.values(1 + dim + c)[local]});
    }
  });
  return held;
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
