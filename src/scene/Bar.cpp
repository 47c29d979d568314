#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/EnergyMeter.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

using std::numbers::pi;

/// A bar, held at one end and free at the other, vibrates in its first mode without damping.
/// Exact for small strain: v = v0 sin(pi X/2L) cos(omega t) with omega = pi c/2L, c^2 = E/rho; the
/// energy stays. The law takes logarithmic strain, which changes the period by the order of the
/// strain squared, 1e-4 here.
class Bar : public Scene {
 public:
  Bar() {
    m_run.output_dir = "out/bar";
    m_run.largest_courant = 0.2;
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Bar");
    options.integer("cells", m_cells, {4, 100'000}, {"1", "cells over the length", "chosen"});
    options.real("start_velocity", m_velocity,
                 {.minimum = 0.0, .maximum = 1.0, .open_minimum = true},
                 {"m/s", "v0, of the free end at the start", "chosen"});
    options.real("periods", m_periods, options::positive(), {"1", "duration", "chosen"});
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    const auto law = std::make_shared<const material::LinearElastic>(elastic);
    solver::Simulation<1> simulation(setup(law));
    start_moving(simulation);
    RunLoop<1> loop(m_run, simulation);
    vibrate(simulation, loop, EnergyMeter<1>(simulation, *law), summary);
    loop.write_fields();
    loop.summarise(summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("keeps {:.4f} of its energy, phase {:.2g} periods off",
                       summary.number("energy_ratio"), summary.number("error_phase"));
  }

 private:
  static constexpr double length = 25.0;  // m
  static constexpr material::LinearElasticParameters elastic{
      .youngs_modulus = 100.0, .poisson_ratio = 0.0, .density = 0.8};

  static double frequency() {
    return 0.5 * pi / length * std::sqrt(elastic.youngs_modulus / elastic.density);
  }
  static double mode(double X) { return std::sin(0.5 * pi * X / length); }

  solver::SimulationSetup<1> setup(std::shared_ptr<const material::Material> law) const {
    // Air into which the free end moves by v0/omega.
    const double cell = length / static_cast<double>(m_cells);
    const auto cells = static_cast<int>(m_cells) + 2 +
                       static_cast<int>(std::ceil(m_velocity / frequency() / cell));
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells * cell, cells)}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::free}}};
    setup.materials = {std::move(law)};
    setup.filling = {
        [](const Vector<1>& x) { return x[0] < length ? std::optional(0) : std::nullopt; },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  void start_moving(solver::Simulation<1>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      view.velocity[0][p] = m_velocity * mode(view.position[0][p]);
  }

  /// Displacement (m) and velocity (m/s) of the first mode.
  struct Motion {
    double displacement = 0.0, velocity = 0.0;
  };

  /// Projects the particles on the first mode. Collective.
  static Motion measure(const solver::Simulation<1>& simulation) {
    const auto view = simulation.particles().view();
    double displacement = 0.0, velocity = 0.0, square = 0.0;
    for (int p = 0; p < view.count; ++p) {
      const double share = mode(view.position[0][p] - view.displacement[0][p]);
      displacement += share * view.displacement[0][p];
      velocity += share * view.velocity[0][p];
      square += share * share;
    }
    square = petsc::sum(square);
    return {petsc::sum(displacement) / square, petsc::sum(velocity) / square};
  }

  /// Periods by which the mode runs ahead at the middle of the last step, where its velocity lives;
  /// between -1/2 and 1/2.
  static double phase_error(const Motion& before, const Motion& now, double time) {
    const double displacement = 0.5 * (before.displacement + now.displacement);
    const double phase = std::atan2(frequency() * displacement, now.velocity);
    const double error = (phase - frequency() * time) / (2.0 * pi);
    return error - std::round(error);
  }

  void vibrate(solver::Simulation<1>& simulation, RunLoop<1>& loop, EnergyMeter<1> meter,
               io::Summary& summary) const {
    io::CsvFile history(m_run.output_dir + "/history.csv",
                        {"time_s", "end_velocity_m_per_s", "error_phase", "kinetic_energy_J",
                         "strain_energy_J", "total_energy_J", "dt_s", "step"});
    const double end = m_periods * 2.0 * pi / frequency();
    Motion motion{.velocity = m_velocity};
    Energies energies = meter.start();
    double error = 0.0;
    loop.run({.name = "vibration",
              .share_done = [&] { return loop.clock().time_in_stage / end + 1e-12; },
              .after_step =
                  [&] {
                    const run::Clock& clock = loop.clock();
                    const Motion before = std::exchange(motion, measure(simulation));
                    error = phase_error(before, motion, clock.time - 0.5 * clock.dt);
                    energies = meter.after_step(clock.time);
                    if (m_run.row_is_due(clock.step))
                      history.row({energies.time, motion.velocity, error, energies.kinetic,
                                   energies.strain, energies.total(), clock.dt,
                                   static_cast<double>(clock.step)});
                  },
              .end_time = end});
    summary.set("energy_start_J", meter.start().total());
    summary.set("energy_end_J", energies.total());
    summary.set("energy_ratio", energies.total() / meter.start().total());
    summary.set("error_phase", error);
  }

  run::RunOptions m_run;
  std::int64_t m_cells = 50;
  double m_velocity = 0.1;
  double m_periods = 10.0;
};

}  // namespace

std::unique_ptr<Scene> make_bar() {
  return std::make_unique<Bar>();
}

}  // namespace mpm::scene
