#include <gtest/gtest.h>

#include <cmath>

#include "support/Scenes.hpp"

namespace mpm::solver {
namespace {

using test::Snapshot;

SimulationSetup<2> box(double share, grid::Wall wall = grid::Wall::roller) {
  auto setup = test::full_box<2>(
      {basis::KnotLines::uniform(0.0, 2.1, 14), basis::KnotLines::uniform(0.0, 1.8, 12)}, wall);
  setup.averaged_volume_share = share;
  return setup;
}

std::vector<Snapshot<2>> after(double share, int steps,
                               const std::function<Vector<2>(const Vector<2>&)>& velocity) {
  test::TimedSimulation<2> simulation(box(share));
  test::set_velocity<2>(simulation, velocity);
  test::run_steps(simulation, steps, 1e-4);
  return test::snapshots(simulation.particles());
}

/// Different from cell to cell.
Vector<2> rough_motion(const Vector<2>& x) {
  return {0.2 * std::sin(11.0 * x[0]) * std::cos(3.0 * x[1]), 0.2 * std::cos(13.0 * x[1] * x[0])};
}

double total_volume(const std::vector<Snapshot<2>>& particles) {
  double sum = 0.0;
  for (const auto& p : particles) sum += p.volume;
  return sum;
}

double rms_of_volume_change(const std::vector<Snapshot<2>>& particles) {
  const double initial = 2.1 * 1.8 / static_cast<double>(particles.size());
  double squares = 0.0;
  for (const auto& p : particles) squares += std::pow(p.volume / initial - 1.0, 2);
  return std::sqrt(squares / static_cast<double>(particles.size()));
}

TEST(Averaging, keeps_a_uniform_volume_change) {
  const auto swell = [](const Vector<2>& x) { return Vector<2>{0.7 * x[0], -0.2 * x[1]}; };
  test::TimedSimulation<2> plain(box(0.0, grid::Wall::free)), averaged(box(1.0, grid::Wall::free));
  for (auto* simulation : {&plain, &averaged}) {
    simulation->add_constraint(std::make_shared<test::PrescribedGradient<2>>(
        test::Gradient<2>{{{0.7, 0.0}, {0.0, -0.2}}}));
    test::set_velocity<2>(*simulation, swell);
    test::run_steps(*simulation, 3, 1e-4);
  }
  const auto a = test::snapshots(plain.particles()), b = test::snapshots(averaged.particles());
  ASSERT_NE(a[0].volume, 2.1 * 1.8 / static_cast<double>(a.size()));
  for (std::size_t p = 0; p < a.size(); ++p) {
    EXPECT_NEAR(b[p].volume / a[p].volume, 1.0, 1e-13);
    EXPECT_NEAR(b[p].position[0], a[p].position[0], 1e-14);
  }
}

TEST(Averaging, keeps_the_total_volume_change_and_takes_the_scatter_out) {
  const auto plain = after(0.0, 1, rough_motion), averaged = after(1.0, 1, rough_motion);
  const double rms = rms_of_volume_change(plain);
  ASSERT_GT(rms, 1e-6);
  // exp(theta) differs from 1 + theta by theta^2/2, which averaging does not keep.
  EXPECT_NEAR(total_volume(averaged), total_volume(plain), 1e-4 * rms * 2.1 * 1.8);
  EXPECT_LT(rms_of_volume_change(averaged), 0.7 * rms);
}

TEST(Averaging, of_a_share_leaves_the_rest_of_the_volume_change_to_the_particle) {
  const auto own = after(0.0, 1, rough_motion), mean = after(1.0, 1, rough_motion),
             mixed = after(0.7, 1, rough_motion);
  double largest_difference = 0.0;
  for (std::size_t p = 0; p < own.size(); ++p) {
    const double log_own = std::log(own[p].volume), log_mean = std::log(mean[p].volume);
    largest_difference = std::max(largest_difference, std::abs(log_own - log_mean));
    EXPECT_NEAR(std::log(mixed[p].volume), 0.7 * log_mean + 0.3 * log_own, 1e-14);
  }
  EXPECT_GT(largest_difference, 1e-5);
}

TEST(Averaging, gives_the_same_on_all_ranks) {
  const auto shared = after(1.0, 100, rough_motion);
  const test::SerialWorld alone;
  const auto serial = after(1.0, 100, rough_motion);
  ASSERT_EQ(shared.size(), serial.size());
  for (std::size_t p = 0; p < serial.size(); ++p) {
    EXPECT_NEAR(shared[p].volume / serial[p].volume, 1.0, 1e-11);
    EXPECT_NEAR(shared[p].position[1], serial[p].position[1], 1e-11);
  }
}

}  // namespace
}  // namespace mpm::solver
