#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mpm/cases/EnergyMeter.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

using std::numbers::pi;

constexpr double length = 25.0;  // m
constexpr material::LinearElasticParameters elastic{
    .youngs_modulus = 100.0, .poisson_ratio = 0.0, .density = 0.8};

double frequency() {
  return 0.5 * pi / length * std::sqrt(elastic.youngs_modulus / elastic.density);
}
double mode(double X) {
  return std::sin(0.5 * pi * X / length);
}

/// Displacement (m) and velocity (m/s) of the first mode.
struct ModalMotion {
  double displacement = 0.0, velocity = 0.0;
};

/// Follows the first mode.
class Mode : public run::Observer<1> {
 public:
  explicit Mode(double velocity) : m_motion{.velocity = velocity} {}

  void after_step(const run::Moment<1>& now) override {
    const ModalMotion before = std::exchange(m_motion, measure(now.simulation));
    phase_error = error_of_phase(before, m_motion, now.clock.time - 0.5 * now.clock.dt);
  }
  void persist(Archive& archive) override {
    archive("displacement", m_motion.displacement);
    archive("velocity", m_motion.velocity);
    archive("phase_error", phase_error);
  }

  double velocity() const { return m_motion.velocity; }
  double phase_error = 0.0;  ///< periods

 private:
  /// Projects the particles on the first mode. Collective.
  static ModalMotion measure(const solver::Simulation<1>& simulation) {
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
  static double error_of_phase(const ModalMotion& before, const ModalMotion& now, double time) {
    const double displacement = 0.5 * (before.displacement + now.displacement);
    const double phase = std::atan2(frequency() * displacement, now.velocity);
    const double error = (phase - frequency() * time) / (2.0 * pi);
    return error - std::round(error);
  }

  ModalMotion m_motion;
};

/// A bar, held at one end and free at the other, vibrates in its first mode without damping.
/// Exact for small strain: v = v0 sin(pi X/2L) cos(omega t) with omega = pi c/2L, c^2 = E/rho; the
/// energy stays. The law takes logarithmic strain, which changes the period by the order of the
/// strain squared, 1e-4 here.
class Bar : public GridCase<1> {
 public:
  Bar() {
    m_options.output_dir = "out/bar";
    m_options.largest_courant = 0.2;
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Bar");
    options.integer("cells", m_cells, {4, 100'000}, {"1", "cells over the length", "chosen"});
    options.real("start_velocity", m_velocity,
                 {.minimum = 0.0, .maximum = 1.0, .open_minimum = true},
                 {"m/s", "v0, of the free end at the start", "chosen"});
    options.real("periods", m_periods, options::positive(), {"1", "duration", "chosen"});
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("keeps {:.4f} of its energy, phase {:.2g} periods off",
                       summary.number("energy_ratio"), summary.number("error_phase"));
  }

 private:
  solver::SimulationSetup<1> setup(std::shared_ptr<const material::Material> law) const {
    // Air into which the free end moves by v0/omega.
    const double cell = length / static_cast<double>(m_cells);
    const auto cells = static_cast<int>(m_cells) + 2 +
                       static_cast<int>(std::ceil(m_velocity / frequency() / cell));
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells * cell, cells)}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::free}}};
    setup.materials = {std::move(law)};
    setup.filling.material_at = [](const Vector<1>& x) {
      return x[0] < length ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  void start_moving(solver::Simulation<1>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      view.velocity[0][p] = m_velocity * mode(view.position[0][p]);
  }

  run::Problem<1> problem() override {
    const auto law = std::make_shared<const material::LinearElastic>(elastic);
    m_mode = std::make_shared<Mode>(m_velocity);
    m_energies = std::make_shared<EnergyMeter<1>>(law);
    run::Problem<1> problem{.setup = setup(law)};
    problem.arrange = [this](solver::Simulation<1>& simulation) { start_moving(simulation); };
    problem.stages = {
        {.name = "vibration",
         .ending = std::make_shared<run::AfterTime<1>>(m_periods * 2.0 * pi / frequency())}};
    problem.observers = {m_mode, m_energies,
                         std::make_shared<run::History<1>>(run::HistoryTable<1>{
                             .path = path("history.csv"),
                             .columns = {"time_s", "end_velocity_m_per_s", "error_phase",
                                         "kinetic_energy_J", "strain_energy_J", "total_energy_J"},
                             .row =
                                 [this](const run::Moment<1>&) {
                                   return std::vector<double>{
                                       m_energies->now.time,   m_mode->velocity(),
                                       m_mode->phase_error,    m_energies->now.kinetic,
                                       m_energies->now.strain, m_energies->now.total()};
                                 },
                             .cadence = every_step()})};
    return problem;
  }

  void evaluate(run::Run<1>&, io::Summary& summary) override {
    const double start = m_energies->start.total(), end = m_energies->now.total();
    summary.set("energy_start_J", start);
    summary.set("energy_end_J", end);
    summary.set("energy_ratio", end / start);
    summary.set("error_phase", m_mode->phase_error);
  }

  std::shared_ptr<Mode> m_mode;
  std::shared_ptr<EnergyMeter<1>> m_energies;
  std::int64_t m_cells = 50;
  double m_velocity = 0.1;
  double m_periods = 10.0;
};

}  // namespace

std::unique_ptr<Case> make_bar() {
  return std::make_unique<Bar>();
}

}  // namespace mpm::cases
