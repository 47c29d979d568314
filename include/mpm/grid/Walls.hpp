#pragma once

#include <array>
#include <vector>

#include "mpm/grid/NodalField.hpp"

namespace mpm::grid {

/// What holds at an end of a direction.
enum class Wall {
  free,      ///< nothing; the body must not reach it
  roller,    ///< no velocity normal to the wall, free along it
  symmetry,  ///< a roller that is the middle of a larger body
  fixed      ///< no velocity at all
};

/// Walls at the ends of the grid. With mirrored splines the nodes beyond a wall belong to the
/// mirrored twin: what is deposited there is folded back onto their reflections, even for mass
/// and components along a roller, odd for the held components (all of them at a fixed wall).
template <int dim>
class Walls {
 public:
  using Kinds = std::array<std::array<Wall, 2>, dim>;  ///< [direction][0: first, 1: last line]

  explicit Walls(const Kinds& kinds) : m_kinds(kinds) {}

  Wall kind(int d, int side) const { return m_kinds[d][side]; }

  /// What is about to be folded away or held on an owned node of a wall, of one component.
  struct Held {
    int wall;        ///< 2 d + side
    int component;   ///< of vectors
    int reflection;  ///< local; -1 for a node on the wall itself
    double mass, momentum, force;
  };
  /// The same as fold, for the field of mass, momentum and force, with what it takes away. Local.
  std::vector<Held> fold_sums(const Grid<dim>& grid, NodalField<dim>& sums) const;
  /// What hold would take away from that field. Local.
  std::vector<Held> about_to_hold(const Grid<dim>& grid, NodalField<dim>& sums) const;

  /// Folds summed deposits on owned nodes and sets held components at the wall to zero. Local.
  void fold(const Grid<dim>& grid, NodalField<dim>& field) const;
  /// Sets held components on owned wall nodes to zero. Local.
  void hold(const Grid<dim>& grid, NodalField<dim>& field) const;
  /// Gives the owned nodes beyond a wall the values of the twin. Local.
  void unfold(const Grid<dim>& grid, NodalField<dim>& field) const;

 private:
  bool is_held(int d, int side, Component component) const;
  template <class Visit>
  void for_each_wall(const Visit& visit) const;
  /// visit(value beyond the wall, value of its reflection, sign) on owned nodes.
  void fold_node(NodalField<dim>& field, int d, int side, int beyond, int reflection) const;
  template <class Visit>
  void for_each_held_node(const Grid<dim>& grid, const Visit& visit) const;
  template <class Visit>
  void for_each_pair(const Grid<dim>& grid, NodalField<dim>& field, const Visit& visit) const;

  Kinds m_kinds;
};

extern template class Walls<1>;
extern template class Walls<2>;
extern template class Walls<3>;

}  // namespace mpm::grid
