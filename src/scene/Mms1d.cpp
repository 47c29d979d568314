#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/scene/DisplacementError.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

using std::numbers::pi;

constexpr int the_bar = 0;  // the only material

/// u = A sin(2 pi X) cos(c pi t) on 0 <= X <= 1 with P = E/2 (F - 1/F), held at both ends; the
/// body force c^2 pi^2 u (1 + 2/F^2) makes it exact. Starts deformed and at rest, one period 2/c.
class Mms1d : public Scene {
 public:
  Mms1d() {
    m_run.output_dir = "out/mms1d";
    m_run.largest_courant = 0.2;
    m_run.particles_per_cell_direction = 4;
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Manufactured solution");
    options.integer("cells", m_cells, {3, 100'000}, {"1", "cells over the length", "chosen"});
    options.real("amplitude", m_amplitude,
                 {.minimum = 0.0, .maximum = 0.15, .open_minimum = true, .open_maximum = true},
                 {"m", "A; 0.05 makes particles cross cells", "chosen"});
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    solver::Simulation<1> simulation(setup());
    deform(simulation);
    simulation.set_body_force(
        [&](const Vector<1>& X, double t) { return Vector<1>{body_force(X[0], t)}; });
    RunLoop<1> loop(m_run, simulation);
    io::CsvFile history(m_run.output_dir + "/history.csv",
                        {"time_s", "error_displacement_rms", "kinetic_energy_J", "dt_s", "step"});
    const double period = 2.0 / c();
    double largest = 0.0;
    loop.run({.name = "vibration",
              .share_done = [&] { return loop.clock().time_in_stage / period + 1e-12; },
              .after_step =
                  [&] {
                    const double error = displacement_error(simulation, loop.clock().time);
                    largest = std::max(largest, error);
                    const run::Clock& clock = loop.clock();
                    if (m_run.row_is_due(clock.step))
                      history.row({clock.time, error, simulation.kinetic_energy(), clock.dt,
                                   static_cast<double>(clock.step)});
                  },
              .end_time = period});
    loop.write_fields();
    loop.summarise(summary);
    summary.set("error_displacement_rms", largest);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("rms error of displacement {:.3g} of the amplitude",
                       summary.number("error_displacement_rms"));
  }

 private:
  static constexpr double youngs_modulus = 1e4;  // Pa
  static double c() { return std::sqrt(youngs_modulus); }

  double displacement(double X, double t) const {
    return m_amplitude * std::sin(2 * pi * X) * std::cos(c() * pi * t);
  }
  double stretch(double X, double t) const {
    return 1.0 + 2 * pi * m_amplitude * std::cos(2 * pi * X) * std::cos(c() * pi * t);
  }
  double body_force(double X, double t) const {
    const double F = stretch(X, t);
    return c() * c() * pi * pi * displacement(X, t) * (1.0 + 2.0 / (F * F));
  }

  solver::SimulationSetup<1> setup() const {
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, 1.0, static_cast<int>(m_cells))}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::fixed}}};
    setup.materials = {std::make_shared<material::NeoHookean>(material::NeoHookeanParameters{
        .youngs_modulus = youngs_modulus, .poisson_ratio = 0.0, .density = 1.0})};
    setup.filling = {
        [](const auto&) { return the_bar; },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  /// Puts the particles, seeded in the undeformed bar, to where they are at t = 0.
  void deform(solver::Simulation<1>& simulation) const {
    {
      const auto view = simulation.particles().view();
      double* J = view[simulation.particles().state(the_bar, "volume_ratio")];
      for (int p = 0; p < view.count; ++p) {
        const double X = view.position[0][p], F = stretch(X, 0.0);
        view.displacement[0][p] = displacement(X, 0.0);
        view.position[0][p] += view.displacement[0][p];
        view.volume[p] *= F;
        view.stress[0][p] = 0.5 * youngs_modulus * (F - 1.0 / F);
        J[p] = F;
      }
    }
    simulation.particles().migrate();
  }

  /// Share of the amplitude.
  double displacement_error(const solver::Simulation<1>& simulation, double time) const {
    return rms_displacement_error<1>(
               simulation,
               [&](const Vector<1>& X) { return Vector<1>{displacement(X[0], time)}; }) /
           m_amplitude;
  }

  run::RunOptions m_run;
  std::int64_t m_cells = 64;
  double m_amplitude = 0.05;
};

}  // namespace

std::unique_ptr<Scene> make_mms1d() {
  return std::make_unique<Mms1d>();
}

}  // namespace mpm::scene
