#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/core/Errors.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/Scene.hpp"
#include "mpm/scene/Settling.hpp"

namespace mpm::scene {
namespace {

/// A bar held at one end and pulled at the other by boundary particles (Eq. 4), until it is at
/// rest. Exact: the stress is the traction, everywhere.
class Traction : public Scene {
 public:
  Traction() {
    m_run.output_dir = "out/traction";
    m_run.largest_courant = 0.5;
    m_material.parameters() = {.youngs_modulus = 1e6, .poisson_ratio = 0.0, .density = 1200.0};
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Traction");
    options.integer("cells", m_cells, {4, 100'000}, {"1", "cells over the length", "chosen"});
    options.real("length", m_length, options::positive(), {"m", "undeformed", "chosen"});
    options.real("traction", m_traction, {},
                 {"Pa", "on the free end, positive where it pulls", "chosen"});
    options.real("damping", m_damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
                 {"1", "local damping, f -= damping |f| sign(v)", "chosen"});
    options.real("rest_tolerance", m_tolerance, options::positive(),
                 {"1", "ends when sum |f| falls below this share of the traction", "chosen"});
    m_material.declare(options);
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    if (m_traction == 0.0)
      throw BadInput("-traction 0 leaves nothing to measure: give a pull or a push");
    solver::Simulation<1> simulation(setup());
    const double spacing =
        m_length / static_cast<double>(m_cells * m_run.particles_per_cell_direction);
    const particles::SurfacePiece<1> end{.anchor = {m_length - 0.5 * spacing},
                                         .offset = {0.5 * spacing},
                                         .area = {1.0},
                                         .pressure = -m_traction};
    simulation.boundary().add({&end, 1});
    RunLoop<1> loop(m_run, simulation);
    double unbalanced = 1.0;
    settle(simulation, loop,
           {.name = "pulling",
            .is_main = true,
            .damping = m_damping,
            .tolerance = m_tolerance,
            .reference_force = std::abs(m_traction),
            .longest = 10'000'000},
           unbalanced);
    loop.write_fields();
    loop.summarise(summary);
    report_errors(simulation, summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("share of the traction kept by the bar {:.6f}, by its worst particle {:.6f}",
                       1.0 - summary.number("error_stress_mean"),
                       1.0 - summary.number("error_stress_peak"));
  }

 private:
  solver::SimulationSetup<1> setup() const {
    // A quarter of the length is air, into which the bar may stretch.
    const auto cells = static_cast<int>(m_cells + (m_cells + 3) / 4);
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, m_length * cells / static_cast<double>(m_cells),
                                            cells)}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::free}}};
    setup.materials = {m_material.create()};
    setup.filling = {
        [this](const Vector<1>& x) { return x[0] < m_length ? std::optional(0) : std::nullopt; },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  void report_errors(const solver::Simulation<1>& simulation, io::Summary& summary) const {
    const auto view = simulation.particles().view();
    double stress = 0.0, volume = 0.0, peak = 0.0;
    for (int p = 0; p < view.count; ++p) {
      stress += view.volume[p] * view.stress[0][p];
      volume += view.volume[p];
      peak = std::max(peak, std::abs(1.0 - view.stress[0][p] / m_traction));
    }
    const double kept = petsc::sum(stress) / petsc::sum(volume) / m_traction;
    summary.set("error_stress_mean", 1.0 - kept);
    summary.set("error_stress_peak", petsc::maximum(peak));
  }

  run::RunOptions m_run;
  std::int64_t m_cells = 20;
  double m_length = 25.0;
  double m_traction = 3e3;
  double m_damping = 0.1;
  double m_tolerance = 1e-9;
  material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Scene> make_traction() {
  return std::make_unique<Traction>();
}

}  // namespace mpm::scene
