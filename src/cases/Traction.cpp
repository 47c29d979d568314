#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/cases/GridCase.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

/// A bar held at one end and pulled at the other by boundary particles (Eq. 4), until it is at
/// rest. Exact: the stress is the traction, everywhere.
class Traction : public GridCase<1> {
 public:
  Traction() {
    m_options.output_dir = "out/traction";
    m_options.largest_courant = 0.5;
    m_material.parameters() = {.youngs_modulus = 1e6, .poisson_ratio = 0.0, .density = 1200.0};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
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

  std::string answer(const io::Summary& summary) const override {
    return fmt::format(
        "share of the traction kept by the bar {:.6f}, error of its worst particle "
        "{:.3g}",
        summary.number("traction_share_kept"), summary.number("error_stress_peak"));
  }

 private:
  solver::SimulationSetup<1> setup() const {
    // A quarter of the length is air, into which the bar may stretch.
    const auto cells = static_cast<int>(m_cells + (m_cells + 3) / 4);
    solver::SimulationSetup<1> setup{
        .lines = {basis::KnotLines::uniform(0.0, m_length * cells / static_cast<double>(m_cells),
                                            cells)}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::fixed, grid::Wall::free}}};
    setup.materials = {m_material.create()};
    setup.filling.material_at = [this](const Vector<1>& x) {
      return x[0] < m_length ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  run::Problem<1> problem() override {
    if (m_traction == 0.0)
      throw BadInput("-traction 0 leaves nothing to measure: give a pull or a push");
    const double spacing =
        m_length / static_cast<double>(m_cells * m_options.particles_per_cell_direction);
    run::Problem<1> problem{.setup = setup()};
    problem.loaded_surface = {{.anchor = {m_length - 0.5 * spacing},
                               .offset = {0.5 * spacing},
                               .area = {1.0},
                               .pressure = -m_traction}};
    problem.stages = {{.name = "pulling",
                       .ending = std::make_shared<run::AtRest<1>>(
                           run::RestOptions<1>{.tolerance = m_tolerance,
                                               .reference_force = std::abs(m_traction),
                                               .longest = 10'000'000}),
                       .damping = m_damping}};
    return problem;
  }

  void evaluate(run::Run<1>& run, io::Summary& summary) override {
    const auto view = run.simulation().particles().view();
    double stress = 0.0, volume = 0.0, peak = 0.0;
    for (int p = 0; p < view.count; ++p) {
      stress += view.volume[p] * view.stress[0][p];
      volume += view.volume[p];
      peak = std::max(peak, std::abs(1.0 - view.stress[0][p] / m_traction));
    }
    const double kept = petsc::sum(stress) / petsc::sum(volume) / m_traction;
    summary.set("traction_share_kept", kept);
    summary.set("error_stress_mean", 1.0 - kept);
    summary.set("error_stress_peak", petsc::maximum(peak));
  }

  std::int64_t m_cells = 20;
  double m_length = 25.0;
  double m_traction = 3e3;
  double m_damping = 0.1;
  double m_tolerance = 1e-9;
  material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Case> make_traction() {
  return std::make_unique<Traction>();
}

}  // namespace mpm::cases
