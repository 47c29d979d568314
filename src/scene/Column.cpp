#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/Scene.hpp"
#include "mpm/scene/Settling.hpp"

namespace mpm::scene {
namespace {

/// A column of height l0 on a fixed base settles under its own weight with local damping. One
/// dimension is all it needs. Exact: sigma = -rho0 g (l0 - Y) at the undeformed height Y.
class Column : public Scene {
 public:
  Column() {
    m_run.output_dir = "out/column";
    m_material.parameters() = {.youngs_modulus = 1e6, .poisson_ratio = 0.0, .density = 80.0};
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
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

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    const std::shared_ptr<const material::Material> law = m_material.create();
    solver::Simulation<1> simulation(setup(law));
    RunLoop<1> loop(m_run, simulation);
    io::CsvFile history(m_run.output_dir + "/history.csv",
                        {"time_s", "out_of_balance", "kinetic_energy_J", "dt_s", "step"});
    const auto row = [&](double unbalanced) {
      const Clock& clock = loop.clock();
      history.row({clock.time, unbalanced, simulation.kinetic_energy(), clock.dt,
                   static_cast<double>(clock.step)});
    };
    double unbalanced = 1.0;
    settle(simulation, loop,
           {.name = "settling",
            .is_main = true,
            .damping = m_damping,
            .tolerance = m_tolerance,
            .longest = 10'000'000,
            .check_every = m_run.history_every > 0 ? m_run.history_every : 100,
            .after_check = row},
           unbalanced);
    loop.write_fields();
    loop.summarise(summary);
    report_errors(simulation, *law, summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("error of stress: mean {:.3g}, peak {:.3g} of the stress at the base",
                       summary.number("error_stress_mean"), summary.number("error_stress_peak"));
  }

 private:
  solver::SimulationSetup<1> setup(std::shared_ptr<const material::Material> law) const {
    // Two cells of air above, so that the surface is free.
    const auto cells = static_cast<int>(m_cells);
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, m_height * (cells + 2) / cells, cells + 2)}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::free}}};
    setup.materials = {std::move(law)};
    setup.filling = {
        [this](const Vector<1>& y) { return y[0] < m_height ? std::optional(0) : std::nullopt; },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    setup.gravity = {-m_gravity};
    return setup;
  }

  void report_errors(const solver::Simulation<1>& simulation, const material::Material& law,
                     io::Summary& summary) const {
    const auto view = simulation.particles().view();
    const double largest_exact = law.initial_density() * m_gravity * m_height;
    double sum = 0.0, peak = 0.0;
    for (int p = 0; p < view.count; ++p) {
      const double Y = view.position[0][p] - view.displacement[0][p];
      const double exact = -law.initial_density() * m_gravity * (m_height - Y);
      const double error = std::abs(view.stress[0][p] - exact) / largest_exact;
      sum += error;
      peak = std::max(peak, error);
    }
    const auto count = static_cast<double>(simulation.particles().global_count());
    summary.set("error_stress_mean", petsc::sum(sum) / count);
    summary.set("error_stress_peak", petsc::maximum(peak));
  }

  RunOptions m_run;
  std::int64_t m_cells = 64;
  double m_height = 50.0;
  double m_gravity = 10.0;
  double m_damping = 0.1;
  double m_tolerance = 1e-9;
  material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Scene> make_column() {
  return std::make_unique<Column>();
}

}  // namespace mpm::scene
