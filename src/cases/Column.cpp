#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/cases/GridCase.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

/// A column of height l0 on a fixed base settles under its own weight with local damping. One
/// dimension is all it needs. Exact: sigma = -rho0 g (l0 - Y) at the undeformed height Y.
class Column : public GridCase<1> {
 public:
  Column() {
    m_options.output_dir = "out/column";
    m_material.parameters() = {.youngs_modulus = 1e6, .poisson_ratio = 0.0, .density = 80.0};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Column");
    options.integer("cells", m_cells, {4, 100'000}, {"1", "cells over the height", "chosen"});
    options.real("height", m_height, options::positive(), {"m", "l0, undeformed", "chosen"});
    options.real("gravity", m_gravity, options::positive(), {"m/s^2", "downward", "chosen"});
    options.real("damping", m_damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
                 {"1", "local damping, f -= damping |f| sign(v)", "chosen"});
    options.real("geostatic_tolerance", m_tolerance, options::positive(),
                 {"1", "ends when sum |f| falls below this share of the weight", "chosen"});
    m_material.declare(options);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("error of stress: mean {:.3g}, peak {:.3g} of the stress at the base",
                       summary.number("error_stress_mean"), summary.number("error_stress_peak"));
  }

 private:
  run::Problem<1> problem() override {
    const long long check_every = m_options.history_every > 0 ? m_options.history_every : 100;
    run::Problem<1> problem{.setup = setup()};
    problem.stages = {
        {.name = "settling",
         .ending = std::make_shared<run::AtRest<1>>(run::RestOptions<1>{
             .tolerance = m_tolerance, .longest = 10'000'000, .check_every = check_every}),
         .damping = m_damping}};
    problem.observers = {
        std::make_shared<run::History<1>>(
            run::HistoryTable<1>{.path = path("history.csv"),
                                 .columns = {"time_s", "out_of_balance", "kinetic_energy_J"},
                                 .row =
                                     [](const run::Moment<1>& now) {
                                       return std::vector<double>{
                                           now.clock.time,
                                           run::unbalanced_share(now.simulation, 0.0),
                                           now.simulation.kinetic_energy()};
                                     },
                                 .cadence = run::Cadence<1>(check_every)})};
    return problem;
  }

  solver::SimulationSetup<1> setup() const {
    // Two cells of air above, so that the surface is free.
    const auto cells = static_cast<int>(m_cells);
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, m_height * (cells + 2) / cells, cells + 2)}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::free}}};
    setup.materials = {m_material.create()};
    setup.filling.material_at = [this](const Vector<1>& y) {
      return y[0] < m_height ? std::optional(0) : std::nullopt;
    };
    setup.gravity = {-m_gravity};
    return setup;
  }

  void evaluate(run::Run<1>& run, io::Summary& summary) override {
    const particles::Particles<1>& particles = run.simulation().particles();
    const double weight = particles.materials()[0]->initial_density() * m_gravity;
    const auto view = particles.view();
    double sum = 0.0, peak = 0.0;
    for (int p = 0; p < view.count; ++p) {
      const double Y = view.position[0][p] - view.displacement[0][p];
      const double exact = -weight * (m_height - Y);
      const double error = std::abs(view.stress[0][p] - exact) / (weight * m_height);
      sum += error;
      peak = std::max(peak, error);
    }
    summary.set("error_stress_mean",
                petsc::sum(sum) / static_cast<double>(particles.global_count()));
    summary.set("error_stress_peak", petsc::maximum(peak));
  }

  std::int64_t m_cells = 64;
  double m_height = 50.0;
  double m_gravity = 10.0;
  double m_damping = 0.1;
  double m_tolerance = 1e-9;
  material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Case> make_column() {
  return std::make_unique<Column>();
}

}  // namespace mpm::cases
