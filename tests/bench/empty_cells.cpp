#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "CpuTime.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/solver/Simulation.hpp"

// What cells without particles cost: a block of 40000 particles on 10000 cells, alone and with ten
// times as many empty cells around it, stepped in turns on one rank. Prints a line of CSV.

namespace mpm {
namespace {

constexpr int block = 100;  // cells per direction
constexpr int margin = 4;
constexpr int warm_up = 10, steps = 10, repetitions = 15;

std::unique_ptr<solver::Simulation<2>> block_with(int cells_beside, int cells_above) {
  const double h = 0.01;
  const auto line = [&](int beyond) {
    const int cells = block + 2 * margin + beyond;
    return basis::KnotLines::uniform(-margin * h, (cells - margin) * h, cells);
  };
  solver::SimulationSetup<2> setup{.lines = {line(cells_beside), line(cells_above)}};
  setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
  setup.materials = {std::make_shared<material::LinearElastic>(material::LinearElasticParameters{
      .youngs_modulus = 1e6, .poisson_ratio = 0.3, .density = 1500.0})};
  setup.filling = {[=](const Vector<2>& x) {
                     const bool inside =
                         x[0] > 0.0 && x[0] < block * h && x[1] > 0.0 && x[1] < block * h;
                     return inside ? std::optional(0) : std::nullopt;
                   },
                   [](const auto&) { return 2; }};
  return std::make_unique<solver::Simulation<2>>(setup);
}

double seconds_of(solver::Simulation<2>& simulation, int count) {
  const double begin = bench::cpu_seconds();
  for (int k = 0; k < count; ++k) simulation.advance(0.0, simulation.plan());
  return bench::cpu_seconds() - begin;
}

void measure() {
  const auto full = block_with(0, 0), spacious = block_with(230, 240);
  seconds_of(*full, warm_up);
  seconds_of(*spacious, warm_up);
  std::vector<double> ratios;
  for (int k = 0; k < repetitions; ++k) {
    const double alone = seconds_of(*full, steps);
    ratios.push_back(seconds_of(*spacious, steps) / alone);
  }
  std::sort(ratios.begin(), ratios.end());
  fmt::print("cells,cells_with_empty_ones,time_ratio_median,time_ratio_min,time_ratio_max\n");
  fmt::print("{},{},{:.4f},{:.4f},{:.4f}\n", full->grid().global_cells(),
             spacious->grid().global_cells(), ratios[repetitions / 2], ratios.front(),
             ratios.back());
}

}  // namespace
}  // namespace mpm

int main() {
  const mpm::petsc::Session session;
  mpm::measure();
}
