#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "mpm/core/Errors.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/scene/DisplacementError.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"
#include "mpm/scene/VortexMotion.hpp"

namespace mpm::scene {
namespace {

/// The generalised vortex in a free ring, exact at any amplitude: see VortexMotion. Starts
/// undeformed at full speed and ends when it is back. The particles stand on the cells of a
/// Cartesian grid, so the ring's edges are stairs.
class Vortex : public Scene {
 public:
  Vortex() {
    m_run.output_dir = "out/vortex";
    m_run.largest_courant = 0.4;
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Generalised vortex");
    options.integer("cells", m_cells, {8, 10'000}, {"1/m", "cells per metre", "chosen"});
    options.real("amplitude", m_amplitude, {.minimum = 0.0, .maximum = 10.0, .open_minimum = true},
                 {"rad", "A, the largest angle by which a circle turns", "chosen"});
    options.real(
        "failure_share", m_failure_share, options::positive(),
        {"1", "share of the amplitude at which the rms error counts as failure", "chosen"});
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    solver::Simulation<2> simulation(setup());
    start_moving(simulation);
    simulation.set_body_force(
        [&](const Vector<2>& X, double t) { return motion().body_force(X, t); });
    RunLoop<2> loop(m_run, simulation);
    try {
      turn(simulation, loop);
    } catch (const NumericalFailure& failure) {
      throw with_time_to_failure(failure);
    }
    loop.write_fields();
    loop.summarise(summary);
    summary.set("error_displacement_rms", m_largest_error);
    if (m_failed_at) summary.set("time_to_failure_s", *m_failed_at);
  }

  std::string answer(const io::Summary& summary) const override {
    std::string text = fmt::format("rms error of displacement {:.3g} of the amplitude",
                                   summary.number("error_displacement_rms"));
    if (!m_failed_at) return text;
    return text + fmt::format(", failed at {:.3g} s", *m_failed_at);
  }

 private:
  static constexpr double half_period = 1.0;  // s
  static constexpr double mid_radius = 1.0;   // m, the radius that turns the most
  static constexpr int cells_of_air = 4;      // beyond the ring
  static constexpr material::NeoHookeanParameters law{
      .youngs_modulus = 1000.0, .poisson_ratio = 0.3, .density = 1000.0};

  VortexMotion motion() const {
    const double shear_modulus = law.youngs_modulus / (2.0 * (1.0 + law.poisson_ratio));
    return {m_amplitude, half_period, shear_modulus / law.density};
  }
  double amplitude_in_metres() const { return m_amplitude * mid_radius; }

  solver::SimulationSetup<2> setup() const {
    const auto cells = static_cast<double>(m_cells);
    const int half = static_cast<int>(std::ceil(VortexMotion::outer_radius * cells)) + cells_of_air;
    const auto line = basis::KnotLines::uniform(-half / cells, half / cells, 2 * half);
    solver::SimulationSetup<2> setup{.lines = {line, line}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    setup.materials = {std::make_shared<material::NeoHookean>(law)};
    setup.filling = {
        [](const Vector<2>& X) {
          const double R = std::hypot(X[0], X[1]);
          const bool inside = R > VortexMotion::inner_radius && R < VortexMotion::outer_radius;
          return inside ? std::optional(0) : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  void start_moving(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const Vector<2> v = motion().velocity(view.position_of(p), 0.0);
      for (int d = 0; d < 2; ++d) view.velocity[d][p] = v[d];
    }
  }

  void turn(solver::Simulation<2>& simulation, RunLoop<2>& loop) {
    io::CsvFile history(
        m_run.output_dir + "/history.csv",
        {"time_s", "error_displacement_rms", "kinetic_energy_J_per_m", "dt_s", "step"});
    const double end = m_run.end_time.value_or(half_period);
    loop.run({.name = "vortex",
              .share_done = [&] { return loop.clock().time_in_stage / end + 1e-12; },
              .after_step =
                  [&] {
                    const run::Clock& clock = loop.clock();
                    const double error = displacement_error(simulation, clock.time);
                    judge(error, clock.time);
                    if (m_run.row_is_due(clock.step))
                      history.row({clock.time, error, simulation.kinetic_energy(), clock.dt,
                                   static_cast<double>(clock.step)});
                  },
              .end_time = end});
  }

  /// Share of the amplitude.
  double displacement_error(const solver::Simulation<2>& simulation, double time) const {
    return rms_displacement_error<2>(
               simulation, [&](const Vector<2>& X) { return motion().displacement(X, time); }) /
           amplitude_in_metres();
  }

  void judge(double error, double time) {
    m_largest_error = std::max(m_largest_error, error);
    if (!m_failed_at && error > m_failure_share) m_failed_at = time;
  }

  /// A run that stops has failed at the latest there.
  NumericalFailure with_time_to_failure(const NumericalFailure& failure) const {
    auto details = nlohmann::ordered_json::parse(failure.details());
    if (m_failed_at)
      details["time_to_failure_s"] = *m_failed_at;
    else if (details.contains("time_s"))
      details["time_to_failure_s"] = details["time_s"];
    return NumericalFailure(failure.what(), details.dump());
  }

  run::RunOptions m_run;
  std::int64_t m_cells = 32;
  double m_amplitude = 0.2;
  double m_failure_share = 0.1;
  double m_largest_error = 0.0;
  std::optional<double> m_failed_at;  ///< s
};

}  // namespace

std::unique_ptr<Scene> make_vortex() {
  return std::make_unique<Vortex>();
}

}  // namespace mpm::scene
