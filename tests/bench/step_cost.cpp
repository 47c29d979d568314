#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "ElasticBlock.hpp"
#include "mpm/petsc/Session.hpp"

// step_cost DIMENSION CELLS PARTICLES_PER_DIRECTION REPETITIONS SECONDS: what a step of an elastic
// block of CELLS per side costs on all ranks; each repetition takes about SECONDS and at least ten
// steps, as often as the time step is renewed. Prints a line of CSV.

namespace mpm {
namespace {

constexpr int period = 10;  // steps between renewals of dt

struct Request {
  bench::Block block;
  int repetitions;
  double seconds;
};

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return petsc::sum(1024.0 * static_cast<double>(usage.ru_maxrss));
}

/// Wall time, the same on all ranks.
template <int dim>
double seconds_of(solver::Simulation<dim>& simulation, int steps) {
  petsc::world().barrier();
  const double begin = MPI_Wtime();
  for (int k = 0; k < steps; ++k) simulation.advance(0.0, simulation.plan());
  return petsc::maximum(MPI_Wtime() - begin);
}

template <int dim>
void measure(const Request& request) {
  const double before = peak_memory_bytes();
  const auto simulation = bench::make_elastic_block<dim>(request.block);
  const double first = seconds_of(*simulation, period);
  const int steps = period * std::max(1, static_cast<int>(request.seconds / first));
  std::vector<double> times;
  for (int k = 0; k < request.repetitions; ++k)
    times.push_back(seconds_of(*simulation, steps) / steps);
  std::sort(times.begin(), times.end());
  const double memory = peak_memory_bytes() - before;
  const auto particles = simulation->particles().global_count();
  const std::size_t bytes = simulation->particles().bytes_per_particle();
  if (petsc::world_rank() != 0) return;
  fmt::print(
      "dimension,particles_per_direction,ranks,cells,particles,steps,step_s,step_s_min,"
      "step_s_max,bytes_per_particle,memory_bytes\n{},{},{},{},{},{},{:.5g},{:.5g},{:.5g},{},{}\n",
      dim, request.block.particles_per_direction, petsc::world_size(),
      simulation->grid().global_cells(), particles, steps, times[times.size() / 2], times.front(),
      times.back(), bytes, memory);
}

}  // namespace
}  // namespace mpm

int main(int count, char** arguments) {
  const mpm::petsc::Session session;
  if (count != 6) {
    if (session.rank() == 0)
      fmt::print(stderr,
                 "usage: step_cost DIMENSION CELLS PARTICLES_PER_DIRECTION REPETITIONS SECONDS\n");
    return 2;
  }
  mpm::Request request{.repetitions = std::atoi(arguments[4]), .seconds = std::atof(arguments[5])};
  request.block.cells = std::atoi(arguments[2]);
  request.block.particles_per_direction = std::atoi(arguments[3]);
  if (std::atoi(arguments[1]) == 3)
    mpm::measure<3>(request);
  else
    mpm::measure<2>(request);
}
