#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

#include "mpm/grid/Walls.hpp"
#include "support/Grids.hpp"

namespace mpm::grid {
namespace {

using basis::KnotLines;
using test::Owners;
using test::Spline;

template <int dim>
std::array<KnotLines, dim> lines() {
  if constexpr (dim == 1) return {test::graded_lines(13)};
  if constexpr (dim == 2) return {test::graded_lines(9), KnotLines::uniform(-1.3, 2.1, 14)};
  if constexpr (dim == 3)
    return {test::graded_lines(7), KnotLines::uniform(-1.3, 0.9, 4), test::graded_lines(10)};
}

/// A grid with uneven ownership ranges or scattered blocks.
template <int dim>
struct UnevenGrid {
  explicit UnevenGrid(Owners owners = Owners::uneven_ranges) {
    test::give_cells_to<dim>(owners, grid, nodes);
  }
  std::array<Spline, dim> splines = test::splines<dim>(lines<dim>());
  std::array<basis::NodeLine, dim> nodes = test::node_lines<dim>(splines);
  Grid<dim> grid{test::world(), nodes, test::uneven_layout<dim>(nodes)};
};

template <int dim>
std::vector<Component> scalar_and_vector() {
  std::vector<Component> components{{Component::scalar}};
  for (int d = 0; d < dim; ++d) components.push_back({d});
  return components;
}

/// Calls check(owners) for every way to share out the cells, and names it where the check fails.
template <class Check>
void for_all_owners(const Check& check) {
  for (const auto& [word, owners] : {std::pair("uneven ranges", Owners::uneven_ranges),
                                     std::pair("scattered blocks", Owners::scattered_blocks)}) {
    SCOPED_TRACE(word);
    check(owners);
  }
}

/// Whether a cell of this rank, or one beside it, reaches the node. Node n is reached by the cells
/// n - 3 to n.
template <int dim>
bool touches(const Grid<dim>& grid, int rank, const std::array<int, dim>& node) {
  Box<dim> cells;
  for (int d = 0; d < dim; ++d) cells.begin[d] = node[d] - 4, cells.end[d] = node[d] + 2;
  bool found = false;
  intersection(cells, grid.all_cells()).for_each([&](int, const auto& cell) {
    found |= grid.rank_of_cell(cell) == rank;
  });
  return found;
}

/// An integer that tells rank, component and node apart.
template <int dim>
double mark(int rank, int component, const std::array<int, dim>& node) {
  double value = 3.0 + 7.0 * component + 1000.0 * rank;
  for (int d = 0; d < dim; ++d) value = 31.0 * value + 5.0 * node[d];
  return value;
}

template <int dim>
void fill_with_marks(const Grid<dim>& grid, int rank, NodalField<dim>& field) {
  for (int c = 0; c < field.components(); ++c)
    grid.for_each_local_node(
        [&](int local, const auto& node) { field.values(c)[local] = mark<dim>(rank, c, node); });
}

template <int dim>
void sums_at_owners_are_those_of_all_ranks(Owners owners) {
  const UnevenGrid<dim> uneven(owners);
  const Grid<dim>& grid = uneven.grid;
  NodalField<dim> field(grid, scalar_and_vector<dim>());
  fill_with_marks(grid, test::world_rank(), field);
  field.sum_to_owners();
  for (int c = 0; c < field.components(); ++c)
    grid.for_each_owned_node([&](int local, const auto& node) {
      double serial = 0.0;
      for (int rank = 0; rank < test::world_size(); ++rank)
        if (touches<dim>(grid, rank, node)) serial += mark<dim>(rank, c, node);
      EXPECT_EQ(field.values(c)[local], serial);
    });
}

TEST(NodalField, sums_at_owners_are_those_of_all_ranks) {
  for_all_owners([](Owners owners) {
    sums_at_owners_are_those_of_all_ranks<1>(owners);
    sums_at_owners_are_those_of_all_ranks<2>(owners);
    sums_at_owners_are_those_of_all_ranks<3>(owners);
  });
}

template <int dim>
void ghosts_are_copies_of_what_their_owner_holds(Owners owners) {
  const UnevenGrid<dim> uneven(owners);
  const Grid<dim>& grid = uneven.grid;
  NodalField<dim> field(grid, scalar_and_vector<dim>());
  fill_with_marks(grid, test::world_rank(), field);
  field.copy_to_ghosts();
  for (int c = 0; c < field.components(); ++c)
    grid.for_each_local_node([&](int local, const auto& node) {
      EXPECT_EQ(field.values(c)[local], mark<dim>(grid.rank_of_node(node), c, node));
    });
}

TEST(NodalField, ghosts_are_copies_of_what_their_owner_holds) {
  for_all_owners([](Owners owners) {
    ghosts_are_copies_of_what_their_owner_holds<1>(owners);
    ghosts_are_copies_of_what_their_owner_holds<2>(owners);
    ghosts_are_copies_of_what_their_owner_holds<3>(owners);
  });
}

template <int dim>
void ownership_is_that_of_the_dmda() {
  const UnevenGrid<dim> uneven;
  const Grid<dim>& grid = uneven.grid;
  std::array<PetscInt, 3> begin{}, size{1, 1, 1};
  DMDAGetCorners(grid.dm(), &begin[0], &begin[1], &begin[2], &size[0], &size[1], &size[2]);
  Box<dim> owned;
  for (int d = 0; d < dim; ++d) owned.begin[d] = begin[d], owned.end[d] = begin[d] + size[d];
  EXPECT_EQ(grid.recorded_nodes(), owned);
  int count = 0;
  grid.for_each_owned_node([&](int, const auto& node) {
    EXPECT_TRUE(owned.contains(node));
    ++count;
  });
  EXPECT_EQ(count, owned.size());
}

TEST(Grid, ownership_is_that_of_the_dmda) {
  ownership_is_that_of_the_dmda<1>();
  ownership_is_that_of_the_dmda<2>();
  ownership_is_that_of_the_dmda<3>();
}

void every_cell_and_node_has_one_owner(Owners owners) {
  const UnevenGrid<2> uneven(owners);
  const Grid<2>& grid = uneven.grid;
  long long cells = 0, nodes = 0;
  grid.all_cells().for_each([&](int, const std::array<int, 2>& cell) {
    const bool mine = grid.rank_of_cell(cell) == test::world_rank();
    EXPECT_EQ(grid.owned_cells().contains(cell), mine);
    cells += mine;
    const Box<2> around{{cell[0] - 1, cell[1] - 1}, {cell[0] + 2, cell[1] + 2}};
    bool beside = false;
    intersection(around, grid.all_cells()).for_each([&](int, const auto& other) {
      beside |= grid.rank_of_cell(other) == test::world_rank();
    });
    EXPECT_EQ(grid.reachable_cells().contains(cell), beside);
    if (!beside) return;
    EXPECT_TRUE(grid.ghosted_nodes().contains(cell));
    EXPECT_TRUE(grid.ghosted_nodes().contains({cell[0] + 3, cell[1] + 3}));
  });
  grid.for_each_owned_node([&](int local, const auto& node) {
    EXPECT_EQ(grid.rank_of_node(node), test::world_rank());
    EXPECT_EQ(local, grid.local_index(node));
    ++nodes;
  });
  EXPECT_EQ(test::world().sum(cells), grid.global_cells());
  EXPECT_EQ(test::world().sum(nodes), grid.nodes(0).count() * grid.nodes(1).count());
}

TEST(Grid, every_cell_and_node_has_one_owner_that_holds_all_nodes_of_the_cells_around) {
  for_all_owners(every_cell_and_node_has_one_owner);
}

TEST(Grid, active_nodes_are_those_that_active_cells_reach) {
  for_all_owners([](Owners owners) {
    UnevenGrid<2> uneven(owners);
    Grid<2>& grid = uneven.grid;
    grid.set_active_cells({{2, 3}, {5, 9}});
    const Box<2> nodes{{2, 3}, {8, 12}};
    long long active = 0, in_runs = 0;
    grid.for_each_active_node([&](int local, const auto& node) {
      EXPECT_TRUE(nodes.contains(node));
      EXPECT_EQ(local, grid.local_index(node));
      ++active;
    });
    grid.for_each_active_run([&](int, int count) { in_runs += count; });
    EXPECT_EQ(active, in_runs);
    EXPECT_EQ(test::world().sum(active), nodes.size());
    EXPECT_FALSE(grid.active_cells().contains({1, 4}));
    EXPECT_EQ(grid.active_cells().contains({4, 8}), grid.reachable_cells().contains({4, 8}));
  });
}

template <int dim>
void a_global_vector_has_what_the_owners_hold(Owners owners) {
  const UnevenGrid<dim> uneven(owners);
  const Grid<dim>& grid = uneven.grid;
  NodalField<dim> field(grid, scalar_and_vector<dim>());
  fill_with_marks(grid, test::world_rank(), field);
  const petsc::VecHandle vector = field.global_vector(1);
  const double* entries = nullptr;
  VecGetArrayRead(vector, &entries);
  grid.recorded_nodes().for_each([&](int k, const auto& node) {
    EXPECT_EQ(entries[k], mark<dim>(grid.rank_of_node(node), 1, node));
  });
  VecRestoreArrayRead(vector, &entries);
}

TEST(NodalField, a_component_as_a_global_vector_is_in_the_order_of_the_dmda) {
  for_all_owners([](Owners owners) {
    a_global_vector_has_what_the_owners_hold<1>(owners);
    a_global_vector_has_what_the_owners_hold<2>(owners);
    a_global_vector_has_what_the_owners_hold<3>(owners);
  });
}

TEST(NodalField, starts_anew_when_nodes_get_other_owners) {
  UnevenGrid<2> uneven;
  NodalField<2> field(uneven.grid, scalar_and_vector<2>());
  fill_with_marks(uneven.grid, 3, field);
  uneven.grid.set_ownership(test::scattered_blocks<2>(uneven.nodes));
  uneven.grid.for_each_local_node(
      [&](int local, const auto&) { EXPECT_EQ(field.values(2)[local], 0.0); });
  fill_with_marks(uneven.grid, test::world_rank(), field);
  field.copy_to_ghosts();
  uneven.grid.for_each_local_node([&](int local, const auto& node) {
    EXPECT_EQ(field.values(2)[local], mark<2>(uneven.grid.rank_of_node(node), 2, node));
  });
}

// Walls, against a body with its mirrored twins ---------------------------------------------

/// A quantity at a point, or at its reflection.
template <int dim>
struct Load {
  Vector<dim> position;
  double scalar;
  Vector<dim> vector;
};

/// Lines reflected at both ends; node a of the part in the middle is node a + cells.
KnotLines with_twins(const KnotLines& lines) {
  std::vector<double> positions;
  const int n = lines.cells();
  for (int k = n; k > 0; --k) positions.push_back(2 * lines.begin() - lines.line(k));
  for (int k = 0; k <= n; ++k) positions.push_back(lines.line(k));
  for (int k = n - 1; k >= 0; --k) positions.push_back(2 * lines.end() - lines.line(k));
  return KnotLines(std::move(positions));
}

/// Adds the twins beyond the walls of direction d, and the twins' twins at corners.
template <int dim>
std::vector<Load<dim>> with_twins(std::vector<Load<dim>> loads, int d, const KnotLines& lines,
                                  const Walls<dim>& walls) {
  const std::vector<Load<dim>> originals = loads;
  for (int side : {0, 1}) {
    if (walls.kind(d, side) == Wall::free) continue;
    for (Load<dim> twin : originals) {
      twin.position[d] = 2 * (side == 0 ? lines.begin() : lines.end()) - twin.position[d];
      for (int c = 0; c < dim; ++c)
        if (c == d || walls.kind(d, side) == Wall::fixed) twin.vector[c] *= -1.0;
      loads.push_back(twin);
    }
  }
  return loads;
}

template <int dim, class Visit>
void for_each_weight(const std::array<Spline, dim>& splines, const Vector<dim>& x,
                     const Visit& visit) {
  std::array<Spline::Values, dim> N, dN;
  std::array<int, dim> cell, node;
  for (int d = 0; d < dim; ++d) {
    cell[d] = splines[d].lines().cell_of(x[d]);
    splines[d].evaluate(cell[d], x[d], N[d], dN[d]);
  }
  for (int k = 0; k < (1 << (2 * dim)); ++k) {
    double weight = 1.0;
    for (int d = 0; d < dim; ++d) {
      const int a = (k >> (2 * d)) % 4;
      weight *= N[d][static_cast<std::size_t>(a)];
      node[d] = cell[d] + a;
    }
    visit(node, weight);
  }
}

template <int dim>
std::vector<Load<dim>> loads_in_every_cell(const std::array<KnotLines, dim>& lines) {
  std::vector<Load<dim>> loads;
  int cells = 1;
  for (int d = 0; d < dim; ++d) cells *= lines[d].cells();
  for (int k = 0; k < cells; ++k) {
    Load<dim> load{{}, 1.7 + std::sin(k), {}};
    for (int d = 0, rest = k; d < dim; rest /= lines[d].cells(), ++d) {
      const int cell = rest % lines[d].cells();
      load.position[d] = lines[d].line(cell) + (0.3 + 0.04 * (k % 7)) * lines[d].width(cell);
      load.vector[d] = 2.3 * std::cos(k + d);
    }
    loads.push_back(load);
  }
  return loads;
}

template <int dim>
void deposit(const UnevenGrid<dim>& uneven, const std::vector<Load<dim>>& loads,
             NodalField<dim>& field) {
  const Grid<dim>& grid = uneven.grid;
  for (const Load<dim>& load : loads) {
    if (!grid.owned_cells().contains(grid.cell_of(load.position))) continue;
    for_each_weight<dim>(uneven.splines, load.position, [&](const auto& node, double weight) {
      const int local = grid.local_index(node);
      field.values(0)[local] += weight * load.scalar;
      for (int d = 0; d < dim; ++d) field.values(1 + d)[local] += weight * load.vector[d];
    });
  }
  field.sum_to_owners();
}

/// Nodal sums of loads and twins, counted from the first node of the part in the middle.
template <int dim>
std::map<std::array<int, dim>, std::array<double, dim + 1>> sums_with_twins(
    const std::array<KnotLines, dim>& half, std::vector<Load<dim>> loads, const Walls<dim>& walls) {
  std::array<KnotLines, dim> full = half;
  for (int d = 0; d < dim; ++d) {
    full[d] = with_twins(half[d]);
    loads = with_twins<dim>(std::move(loads), d, half[d], walls);
  }
  const auto splines = test::splines<dim>(full);
  std::map<std::array<int, dim>, std::array<double, dim + 1>> sums;
  for (const Load<dim>& load : loads)
    for_each_weight<dim>(splines, load.position, [&](auto node, double weight) {
      for (int d = 0; d < dim; ++d) node[d] -= half[d].cells();
      sums[node][0] += weight * load.scalar;
      for (std::size_t d = 0; d < dim; ++d) sums[node][d + 1] += weight * load.vector[d];
    });
  return sums;
}

/// 1 for a wall: the nodes on it carry one half for each that they lie on.
template <int dim>
int walls_at(const Grid<dim>& grid, const Walls<dim>& walls, const std::array<int, dim>& node) {
  int count = 0;
  for (int d = 0; d < dim; ++d)
    count += (node[d] == 1 && walls.kind(d, 0) != Wall::free) ||
             (node[d] == grid.nodes(d).count() - 2 && walls.kind(d, 1) != Wall::free);
  return count;
}

template <int dim>
bool is_beyond(const Grid<dim>& grid, const Walls<dim>& walls, const std::array<int, dim>& node) {
  for (int d = 0; d < dim; ++d)
    if ((node[d] == 0 && walls.kind(d, 0) != Wall::free) ||
        (node[d] == grid.nodes(d).count() - 1 && walls.kind(d, 1) != Wall::free))
      return true;
  return false;
}

template <int dim>
void walls_act_like_mirrored_twins(Owners owners, const typename Walls<dim>::Kinds& kinds) {
  const UnevenGrid<dim> uneven(owners);
  const Grid<dim>& grid = uneven.grid;
  const Walls<dim> walls(kinds);
  const auto loads = loads_in_every_cell<dim>(lines<dim>());
  NodalField<dim> field(grid, scalar_and_vector<dim>());
  deposit<dim>(uneven, loads, field);
  auto exact = sums_with_twins<dim>(lines<dim>(), loads, walls);

  walls.fold(grid, field);
  for (int c = 0; c <= dim; ++c)
    grid.for_each_owned_node([&](int local, const auto& node) {
      const double share = std::pow(0.5, walls_at<dim>(grid, walls, node));
      const double expected = is_beyond<dim>(grid, walls, node)
                                  ? 0.0
                                  : share * exact[node][static_cast<std::size_t>(c)];
      EXPECT_NEAR(field.values(c)[local], expected, 1e-13) << "component " << c;
    });

  // Once it is a velocity, the wall's share of the mass has cancelled.
  for (int c = 0; c <= dim; ++c)
    grid.for_each_owned_node([&](int local, const auto& node) {
      if (!is_beyond<dim>(grid, walls, node))
        field.values(c)[local] = exact[node][static_cast<std::size_t>(c)];
    });
  walls.unfold(grid, field);
  for (int c = 0; c <= dim; ++c)
    grid.for_each_owned_node([&](int local, const auto& node) {
      EXPECT_NEAR(field.values(c)[local], exact[node][static_cast<std::size_t>(c)], 1e-13)
          << "component " << c;
    });
}

TEST(Walls, act_like_mirrored_twins_at_ends_and_corners) {
  for_all_owners([](Owners owners) {
    walls_act_like_mirrored_twins<1>(owners, {{{Wall::roller, Wall::free}}});
    walls_act_like_mirrored_twins<1>(owners, {{{Wall::free, Wall::fixed}}});
    walls_act_like_mirrored_twins<2>(owners,
                                     {{{Wall::symmetry, Wall::roller}, {Wall::fixed, Wall::free}}});
    walls_act_like_mirrored_twins<2>(owners,
                                     {{{Wall::free, Wall::fixed}, {Wall::roller, Wall::fixed}}});
    walls_act_like_mirrored_twins<3>(owners, {{{Wall::symmetry, Wall::free},
                                               {Wall::roller, Wall::fixed},
                                               {Wall::fixed, Wall::symmetry}}});
  });
}

TEST(Walls, held_components_vanish_on_the_wall_and_others_stay) {
  const UnevenGrid<2> uneven;
  const Grid<2>& grid = uneven.grid;
  const Walls<2> walls({{{Wall::roller, Wall::free}, {Wall::free, Wall::fixed}}});
  NodalField<2> field(grid, scalar_and_vector<2>());
  fill_with_marks(grid, 2, field);
  walls.hold(grid, field);
  const int top = grid.nodes(1).count() - 2;
  for (int c = 0; c < 3; ++c)
    grid.for_each_owned_node([&](int local, const auto& node) {
      const bool held = c > 0 && (node[1] == top || (node[0] == 1 && c == 1));
      EXPECT_EQ(field.values(c)[local], held ? 0.0 : mark<2>(2, c, node));
    });
}

}  // namespace
}  // namespace mpm::grid
