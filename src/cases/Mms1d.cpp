#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/cases/DisplacementError.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

using std::numbers::pi;

constexpr int the_bar = 0;  // the only material

/// u = A sin(2 pi X) cos(c pi t) on 0 <= X <= 1 with P = E/2 (F - 1/F), held at both ends; the
/// body force c^2 pi^2 u (1 + 2/F^2) makes it exact. Starts deformed and at rest, one period 2/c.
class Mms1d : public GridCase<1> {
 public:
  Mms1d() {
    m_options.output_dir = "out/mms1d";
    m_options.largest_courant = 0.2;
    m_options.particles_per_cell_direction = 4;
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Manufactured solution");
    options.integer("cells", m_cells, {3, 100'000}, {"1", "cells over the length", "chosen"});
    options.real("amplitude", m_amplitude,
                 {.minimum = 0.0, .maximum = 0.15, .open_minimum = true, .open_maximum = true},
                 {"m", "A; 0.05 makes particles cross cells", "chosen"});
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
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::fixed}}};
    setup.materials = {std::make_shared<material::NeoHookean>(material::NeoHookeanParameters{
        .youngs_modulus = youngs_modulus, .poisson_ratio = 0.0, .density = 1.0})};
    setup.filling.material_at = [](const auto&) { return the_bar; };
    return setup;
  }

  /// Puts the particles, seeded in the undeformed bar, to where they are at t = 0.
  void deform(solver::Simulation<1>& simulation) const {
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

  run::Problem<1> problem() override {
    m_error = std::make_shared<DisplacementError<1>>(
        [this](const Vector<1>& X, double t) { return Vector<1>{displacement(X[0], t)}; },
        m_amplitude);
    run::Problem<1> problem{.setup = setup()};
    problem.arrange = [this](solver::Simulation<1>& simulation) { deform(simulation); };
    problem.body_force = [this](const Vector<1>& X, double t) {
      return Vector<1>{body_force(X[0], t)};
    };
    problem.stages = {
        {.name = "vibration", .ending = std::make_shared<run::AfterTime<1>>(2.0 / c())}};
    problem.observers = {m_error,
                         std::make_shared<run::History<1>>(run::HistoryTable<1>{
                             .path = path("history.csv"),
                             .columns = {"time_s", "error_displacement_rms", "kinetic_energy_J"},
                             .row =
                                 [this](const run::Moment<1>& now) {
                                   return std::vector<double>{now.clock.time, m_error->last,
                                                              now.simulation.kinetic_energy()};
                                 },
                             .cadence = every_step()})};
    return problem;
  }

  void evaluate(run::Run<1>&, io::Summary& summary) override {
    summary.set("error_displacement_rms", m_error->largest);
  }

  std::shared_ptr<DisplacementError<1>> m_error;
  std::int64_t m_cells = 64;
  double m_amplitude = 0.05;
};

}  // namespace

std::unique_ptr<Case> make_mms1d() {
  return std::make_unique<Mms1d>();
}

}  // namespace mpm::cases
