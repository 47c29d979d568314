#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "PlainStep.hpp"

// plain_step DIMENSION CELLS REPETITIONS SECONDS: particle updates per second of the yardstick, a
// block of CELLS per side; each repetition takes about SECONDS. Prints a line of CSV.

namespace mpm::bench {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A body falls as it must whatever happens in it: m g t, and nothing sideways.
template <std::size_t dim>
void check_momentum(const PlainBody<dim>& body, const std::array<double, dim>& start,
                    double impulse, double scale) {
  const auto momentum = body.momentum();
  for (std::size_t d = 0; d < dim; ++d) {
    const double expected = start[d] - (d + 1 == dim ? impulse : 0.0);
    if (std::abs(momentum[d] - expected) < 1e-9 * scale) continue;
    std::fprintf(stderr, "plain_step: momentum %g of direction %zu is not %g\n", momentum[d], d,
                 expected);
    std::exit(1);
  }
}

template <std::size_t dim>
void measure(const Block& block, int repetitions, double seconds) {
  PlainBody<dim> body(block);
  const auto start = body.momentum();
  const double dt = block.time_step(), count = static_cast<double>(body.particles().size());
  double fallen = 0.5 * dt;
  body.step(0.5 * dt, dt);
  const auto seconds_of = [&](int steps) {
    const double begin = now();
    for (int k = 0; k < steps; ++k) body.step(dt, dt);
    fallen += steps * dt;
    return now() - begin;
  };
  const int steps = std::max(5, static_cast<int>(5.0 * seconds / seconds_of(5)));
  std::vector<double> rates;
  for (int k = 0; k < repetitions; ++k) rates.push_back(count * steps / seconds_of(steps));
  std::sort(rates.begin(), rates.end());
  const double weight = body.mass() * block.gravity;
  check_momentum<dim>(body, start, weight * fallen, body.mass() * block.speed + weight * fallen);
  std::printf("dimension,particles,steps,updates_per_s,updates_per_s_min,updates_per_s_max\n");
  std::printf("%zu,%.0f,%d,%.4g,%.4g,%.4g\n", dim, count, steps, rates[rates.size() / 2],
              rates.front(), rates.back());
}

}  // namespace
}  // namespace mpm::bench

int main(int count, char** arguments) {
  if (count != 5) {
    std::fprintf(stderr, "usage: plain_step DIMENSION CELLS REPETITIONS SECONDS\n");
    return 2;
  }
  mpm::bench::Block block;
  block.cells = std::atoi(arguments[2]);
  const int repetitions = std::atoi(arguments[3]);
  const double seconds = std::atof(arguments[4]);
  if (std::atoi(arguments[1]) == 3)
    mpm::bench::measure<3>(block, repetitions, seconds);
  else
    mpm::bench::measure<2>(block, repetitions, seconds);
}
