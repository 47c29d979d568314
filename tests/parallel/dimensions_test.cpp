#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "mpm/petsc/Session.hpp"
#include "support/Scenes.hpp"

namespace mpm::solver {
namespace {

constexpr double h = 0.35;
constexpr int length = 9;  // cells
constexpr int steps = 150;

/// A body between rollers in all directions but the first, where it may leave one wall.
template <int dim>
SimulationSetup<dim> slab(const std::array<int, dim>& cells) {
  SimulationSetup<dim> setup{.lines = [&]<std::size_t... d>(std::index_sequence<d...>){
                                 return std::array<basis::KnotLines, dim>{
                                     basis::KnotLines::uniform(0.0, cells[d] * h, cells[d])...};
}
(std::make_index_sequence<static_cast<std::size_t>(dim)>{})
};  // namespace
setup.walls = test::walls_all<dim>(grid::Wall::roller);
setup.walls[0][1] = grid::Wall::free;
setup.materials = {test::elastic()};
setup.filling = {
    [](const Vector<dim>& x) { return x[0] < (length - 3) * h ? std::optional(0) : std::nullopt; },
    [](const auto&) { return 2; }};
setup.gravity[0] = -3.7;
return setup;
}  // namespace mpm::solver

/// Displacement, velocity and stress along the first direction by undeformed place in the first
/// `directions` directions, of particles of this rank; asks that all particles of a place agree.
using State = std::array<double, 4>;
template <int dim>
std::map<std::vector<long>, State> states_by_place(const test::TimedSimulation<dim>& simulation,
                                                   int directions) {
  std::map<std::vector<long>, State> states;
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p) {
    std::vector<long> place;
    for (int d = 0; d < directions; ++d)
      place.push_back(std::lround(8.0 * (view.position[d][p] - view.displacement[d][p]) / h));
    const double second = dim > 1 && directions > 1 ? view.displacement[1 % dim][p] : 0.0;
    const State state{view.displacement[0][p], view.velocity[0][p], view.stress[0][p], second};
    const auto [found, is_new] = states.emplace(place, state);
    if (is_new) continue;
    for (std::size_t k = 0; k < state.size(); ++k)
      EXPECT_NEAR(found->second[k], state[k], 1e-11 * (1.0 + std::abs(state[k])));
  }
  return states;
}

/// Largest difference of what two simulations have in common on this rank; `common` counts places.
double difference(const std::map<std::vector<long>, State>& a,
                  const std::map<std::vector<long>, State>& b, int& common) {
  double largest = 0.0;
  for (const auto& [place, state] : a) {
    const auto other = b.find(place);
    if (other == b.end()) continue;
    ++common;
    for (std::size_t k = 0; k < state.size(); ++k)
      largest =
          std::max(largest, std::abs(other->second[k] - state[k]) / (1.0 + std::abs(state[k])));
  }
  return largest;
}

TEST(Dimensions, a_column_falls_together_alike_in_one_two_and_three) {
  test::TimedSimulation<1> line(slab<1>({length}));
  test::TimedSimulation<2> plane(slab<2>({length, 4}));
  test::TimedSimulation<3> space(slab<3>({length, 4, 4}));
  test::run_steps(line, steps, 2e-3);
  test::run_steps(plane, steps, 2e-3);
  test::run_steps(space, steps, 2e-3);
  int common = 0;
  const auto exact = states_by_place(line, 1);
  EXPECT_LT(difference(exact, states_by_place(plane, 1), common), 1e-11);
  EXPECT_LT(difference(exact, states_by_place(space, 1), common), 1e-11);
  EXPECT_GT(petsc::sum(static_cast<double>(common)), 4.0);
  double moved = 0.0;
  for (const auto& [place, state] : exact) moved = std::max(moved, std::abs(state[0]));
  EXPECT_GT(petsc::maximum(moved), 0.01 * h);
}

TEST(Dimensions, plane_strain_is_a_slab_between_rollers) {
  const auto squeeze = [](const auto& x) {
    auto v = x;
    for (double& component : v) component = 0.0;
    v[0] = 0.2 * std::sin(1.3 * x[0] + 0.7 * x[1]);
    v[1] = 0.15 * std::cos(0.9 * x[0]) * std::sin(x[1]);
    return v;
  };
  test::TimedSimulation<2> plane(slab<2>({length, 5}));
  test::TimedSimulation<3> slice(slab<3>({length, 5, 4}));
  test::set_velocity<2>(plane, squeeze);
  test::set_velocity<3>(slice, squeeze);
  test::run_steps(plane, steps, 1e-3);
  test::run_steps(slice, steps, 1e-3);
  int common = 0;
  EXPECT_LT(difference(states_by_place(plane, 2), states_by_place(slice, 2), common), 1e-11);
  EXPECT_GT(petsc::sum(static_cast<double>(common)), 8.0);
}

}  // namespace
}  // namespace mpm::solver
