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

enum class PatchWall { roller, fixed };

/// A full box under constant stress: all nodal forces must vanish. Between rollers there is no
/// shear stress, between fixed walls there is.
class Patch : public GridCase<2> {
 public:
  Patch() { m_options.output_dir = "out/patch"; }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Patch");
    options.integer("cells", m_cells, {3, 10'000}, {"1", "cells per direction", "chosen"});
    options.real("amplitude", m_stress, options::positive(),
                 {"Pa", "magnitude of the constant stress", "chosen"});
    options.real("grading", m_grading, options::between(1.0, 3.0),
                 {"1", "ratio of neighbouring cell sizes", "docs/model.md"});
    options.choice("wall", m_wall, {{"roller", PatchWall::roller}, {"fixed", PatchWall::fixed}},
                   {"", "all four walls", "chosen"});
    options.choice(
        "placement", m_placement,
        {{"midpoint", particles::Placement::midpoint}, {"gauss", particles::Placement::gauss}},
        {"", "where particles stand in their cells", "docs/model.md"});
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("largest nodal force {:.3g} of stress times cell face",
                       summary.number("residual_max"));
  }

 private:
  basis::KnotLines lines() const {
    std::vector<double> positions{0.0};
    double width = 0.37;
    for (int k = 0; k < m_cells; ++k, width *= m_grading)
      positions.push_back(positions.back() + width);
    return basis::KnotLines(std::move(positions));
  }

  solver::SimulationSetup<2> setup() const {
    const grid::Wall wall = m_wall == PatchWall::fixed ? grid::Wall::fixed : grid::Wall::roller;
    solver::SimulationSetup<2> setup{.lines = {lines(), lines()}};
    m_options.apply_to(setup);
    setup.walls = {{{wall, wall}, {wall, wall}}};
    setup.materials = {std::make_shared<material::LinearElastic>(
        material::LinearElasticParameters{.youngs_modulus = 3e6, .density = 1700.0})};
    setup.filling = {
        [](const auto&) { return 0; },
        [this](const auto&) { return static_cast<int>(m_options.particles_per_cell_direction); },
        m_placement};
    return setup;
  }

  run::Problem<2> problem() override {
    run::Problem<2> problem{.setup = setup()};
    problem.arrange = [this](solver::Simulation<2>& simulation) { stress_particles(simulation); };
    problem.stages = {{.name = "patch",
                       .ending = std::make_shared<run::AfterSteps<2>>(1),
                       .longest_step = 1e-12}};
    return problem;
  }

  void stress_particles(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    const double shear = m_wall == PatchWall::fixed ? 0.3 * m_stress : 0.0;
    for (int p = 0; p < view.count; ++p) {
      view.stress[0][p] = -m_stress;
      view.stress[1][p] = -0.7 * m_stress;
      view.stress[2][p] = -0.5 * m_stress;
      view.stress[3][p] = shear;
    }
  }

  void evaluate(run::Run<2>& run, io::Summary& summary) override {
    summary.set("residual_max", largest_residual(run.simulation()));
  }

  /// Share of the stress times the smallest face of a cell.
  double largest_residual(const solver::Simulation<2>& simulation) const {
    const grid::NodalField<2>& sums = simulation.step().nodal_sums();
    double largest = 0.0;
    simulation.grid().for_each_owned_node([&](int I, const auto&) {
      for (int d = 0; d < 2; ++d) largest = std::max(largest, std::abs(sums.values(3 + d)[I]));
    });
    return petsc::maximum(largest) / (m_stress * lines().smallest_width());
  }

  std::int64_t m_cells = 8;
  double m_stress = 3e4;
  double m_grading = 1.0;
  PatchWall m_wall = PatchWall::roller;
  particles::Placement m_placement = particles::Placement::midpoint;
};

}  // namespace

std::unique_ptr<Case> make_patch() {
  return std::make_unique<Patch>();
}

}  // namespace mpm::cases
