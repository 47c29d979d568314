#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/cases/DisplacementError.hpp"
#include "mpm/cases/EnergyMeter.hpp"
#include "support/Scenes.hpp"

namespace mpm::cases {
namespace {

using test::equal_lines;

constexpr double side = 2.4;  // m
const auto shared_law = std::make_shared<const material::LinearElastic>(test::soft);
const material::LinearElastic& law = *shared_law;

TEST(EnergyMeter, measures_uniform_stress_and_velocity) {
  test::TimedSimulation<2> simulation(
      test::full_box<2>(equal_lines<2>(-0.3, side - 0.3, 12), grid::Wall::roller));
  const SymmetricTensor strain{{2e-3, -1e-3, 0.0, 7e-4, 0.0, 0.0}};
  test::set_stress(simulation, law.stress_increment(strain));
  test::set_velocity<2>(simulation, [](const auto&) { return Vector<2>{0.3, -0.4}; });
  EnergyMeter<2> meter(shared_law);
  const run::Clock clock;
  meter.begin({simulation, clock});
  const Energies start = meter.start;
  const double area = side * side, volumetric = trace(strain);
  EXPECT_NEAR(start.kinetic, 0.5 * test::soft.density * area * 0.25, 1e-10);
  EXPECT_NEAR(start.strain,
              area * (0.5 * law.lambda() * volumetric * volumetric +
                      law.shear_modulus() * contract(strain, strain)),
              1e-12);
}

/// Kinetic and strain energy taken half a step apart would differ by up to 0.8 % here.
TEST(EnergyMeter, total_energy_of_a_vibrating_bar_stays) {
  auto setup = test::full_box<1>(equal_lines<1>(0.0, side, 40), grid::Wall::fixed);
  setup.courant = 0.2;
  test::TimedSimulation<1> simulation(setup);
  test::set_velocity<1>(simulation, [](const Vector<1>& x) {
    return Vector<1>{1e-3 * std::sin(std::numbers::pi * x[0] / side)};
  });
  EnergyMeter<1> meter(shared_law);
  run::Clock clock;
  meter.begin({simulation, clock});
  const double wave_speed =
      std::sqrt((law.lambda() + 2 * law.shear_modulus()) / test::soft.density);
  double largest = 0.0;
  while (simulation.time() < 2.0 * side / wave_speed) {
    simulation.advance();
    clock.advance(simulation.times);
    meter.after_step({simulation, clock});
    largest = std::max(largest, std::abs(meter.now.total() / meter.start.total() - 1.0));
  }
  EXPECT_LT(largest, 5e-4);
}

TEST(DisplacementError, is_the_root_of_the_mean_square_distance_from_the_exact_field) {
  test::TimedSimulation<2> simulation(
      test::full_box<2>(equal_lines<2>(-0.3, side - 0.3, 12), grid::Wall::roller));
  const auto exact = [](const Vector<2>& X) { return Vector<2>{0.02 * X[1], -0.01 * X[0]}; };
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const Vector<2> u = exact(view.position_of(p));
      const double off = view.id[p] % 2 == 0 ? 3e-3 : -3e-3;
      view.displacement[0][p] = u[0] + off;
      view.displacement[1][p] = u[1] + 4e-3;
      for (int d = 0; d < 2; ++d) view.position[d][p] += view.displacement[d][p];
    }
  }
  EXPECT_NEAR(rms_displacement_error<2>(simulation, exact), 5e-3, 1e-15);
}

}  // namespace
}  // namespace mpm::cases
