#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "mpm/cases/DisplacementError.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/VortexMotion.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

/// The generalised vortex in a free ring, exact at any amplitude: see VortexMotion. Starts
/// undeformed at full speed and ends when it is back. The particles stand on the cells of a
/// Cartesian grid, so the ring's edges are stairs.
class Vortex : public GridCase<2> {
 public:
  Vortex() {
    m_options.output_dir = "out/vortex";
    m_options.largest_courant = 0.4;
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Generalised vortex");
    options.integer("cells", m_cells, {8, 10'000}, {"1/m", "cells per metre", "chosen"});
    options.real("amplitude", m_amplitude, {.minimum = 0.0, .maximum = 10.0, .open_minimum = true},
                 {"rad", "A, the largest angle by which a circle turns", "chosen"});
    options.real(
        "failure_share", m_failure_share, options::positive(),
        {"1", "share of the amplitude at which the rms error counts as failure", "chosen"});
  }

  std::string answer(const io::Summary& summary) const override {
    std::string text = fmt::format("rms error of displacement {:.3g} of the amplitude",
                                   summary.number("error_displacement_rms"));
    if (m_error->failed_at < 0.0) return text;
    return text + fmt::format(", failed at {:.3g} s", m_error->failed_at);
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
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    setup.materials = {std::make_shared<material::NeoHookean>(law)};
    setup.filling.material_at = [](const Vector<2>& X) {
      const double R = std::hypot(X[0], X[1]);
      const bool inside = R > VortexMotion::inner_radius && R < VortexMotion::outer_radius;
      return inside ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  void start_moving(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const Vector<2> v = motion().velocity(view.position_of(p), 0.0);
      for (int d = 0; d < 2; ++d) view.velocity[d][p] = v[d];
    }
  }

  run::Problem<2> problem() override {
    m_error = std::make_shared<DisplacementError<2>>(
        [this](const Vector<2>& X, double t) { return motion().displacement(X, t); },
        amplitude_in_metres(), m_failure_share);
    run::Problem<2> problem{.setup = setup()};
    problem.arrange = [this](solver::Simulation<2>& simulation) { start_moving(simulation); };
    problem.body_force = [this](const Vector<2>& X, double t) { return motion().body_force(X, t); };
    problem.stages = {
        {.name = "vortex",
         .ending = std::make_shared<run::AfterTime<2>>(m_options.end_time.value_or(half_period))}};
    problem.observers = {
        m_error, std::make_shared<run::History<2>>(
                     run::HistoryTable<2>{.path = path("history.csv"),
                                          .columns = {"time_s", "error_displacement_rms",
                                                      "kinetic_energy_J_per_m"},
                                          .row =
                                              [this](const run::Moment<2>& now) {
                                                return std::vector<double>{
                                                    now.clock.time, m_error->last,
                                                    now.simulation.kinetic_energy()};
                                              },
                                          .cadence = every_step()})};
    return problem;
  }

  void evaluate(run::Run<2>&, io::Summary& summary) override {
    summary.set("error_displacement_rms", m_error->largest);
    if (m_error->failed_at >= 0.0) summary.set("time_to_failure_s", m_error->failed_at);
  }

  /// A run that stops has failed at the latest there.
  NumericalFailure explained(const NumericalFailure& failure) const override {
    auto details = nlohmann::ordered_json::parse(failure.details());
    if (m_error->failed_at >= 0.0)
      details["time_to_failure_s"] = m_error->failed_at;
    else if (details.contains("time_s"))
      details["time_to_failure_s"] = details["time_s"];
    return NumericalFailure(failure.what(), details.dump());
  }

  std::shared_ptr<DisplacementError<2>> m_error;
  std::int64_t m_cells = 32;
  double m_amplitude = 0.2;
  double m_failure_share = 0.1;
};

}  // namespace

std::unique_ptr<Case> make_vortex() {
  return std::make_unique<Vortex>();
}

}  // namespace mpm::cases
