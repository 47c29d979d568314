#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

constexpr double run_out_per_aspect_ratio = 1.2;  // measured, for aspect ratios below 2.3
constexpr double room_per_aspect_ratio = 2.6;     // of the grid beyond the column, in widths
constexpr int cells_above = 6;                    // empty
constexpr int cells_below = 4;                    // under a base with friction
constexpr double front_thickness = 0.5;           // of a cell, at which the heap ends
constexpr double longest = 6.0;                   // in sqrt(h0/g); experiments rest after 3.3
constexpr double rows_per_time = 50.0;            // rows of history.csv in sqrt(h0/g)

enum class Base { rough, frictional };

struct CollapseOptions {
  run::RunOptions run;
  mutable material::MohrCoulombFactory material;
  std::int64_t cells = 20;    ///< over the width
  double aspect_ratio = 1.0;  ///< a = h0/l0
  double width = 1.0;         ///< l0, m
  double gravity = 9.81;      ///< m/s^2
  double K0 = 0.5;            ///< at the start
  double rest_tolerance = 1e-3;
  Base base = Base::rough;
  double friction = 0.6;

  CollapseOptions() {
    run.output_dir = "out/collapse";
    run.flip_time = 0.025;  // with the cell size a viscosity: against noise of flying grains
    material.parameters() = {
        .elastic = {.youngs_modulus = 10e6, .poisson_ratio = 0.3, .density = 1600.0},
        .friction_angle = 31.0,
        .dilation_angle = 0.0,
        .cohesion = 0.0};
  }

  double height() const { return aspect_ratio * width; }
  double cell() const { return width / static_cast<double>(cells); }
  double base_height() const { return base == Base::rough ? 0.0 : cells_below * cell(); }
  double time_scale() const { return std::sqrt(height() / gravity); }

  void declare(options::OptionSet& options) {
    run.declare(options);
    options.section("Collapse");
    options.real("aspect_ratio", aspect_ratio, {.minimum = 0.2, .maximum = 10.0},
                 {"1", "height of the column over its width, a = h0/l0", "Lube et al. 2005"});
    options.integer("cells", cells, {4, 2000}, {"1", "cells over the width l0", "chosen"});
    options.real("width", width, options::positive(),
                 {"m", "l0, of the half that is modelled", "chosen"});
    options.real("gravity", gravity, options::positive(), {"m/s^2", "downward", "chosen"});
    options.real("initial_K0", K0, options::between(0.0, 3.0),
                 {"1", "horizontal over vertical stress before the column is let go", "chosen"});
    options.real("rest_tolerance", rest_tolerance, options::positive(),
                 {"1",
                  "ends when the kinetic energy is this share of the column's weight times "
                  "half its height, after its peak",
                  "chosen"});
    options.choice(
        "base", base, {{"rough", Base::rough}, {"frictional", Base::frictional}},
        {"", "what the sand stands on: nothing slips there, or it slides with friction", "chosen"});
    options.real("contact_friction", friction, options::not_negative(),
                 {"1", "Coulomb coefficient mu of a base with friction", "chosen: tan 31"});
    material.declare(options);
  }

  solver::SimulationSetup<2> setup() const {
    const double h = cell();
    const int cells_x = static_cast<int>(
        std::ceil((1.0 + room_per_aspect_ratio * aspect_ratio) * static_cast<double>(cells)));
    const int cells_y = static_cast<int>(std::ceil((base_height() + height()) / h)) + cells_above;
    solver::SimulationSetup<2> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells_x * h, cells_x),
                  basis::KnotLines::uniform(0.0, cells_y * h, cells_y)}};
    run.apply_to(setup);
    const auto bottom = base == Base::rough ? grid::Wall::fixed : grid::Wall::free;
    setup.walls = {{{grid::Wall::symmetry, grid::Wall::free}, {bottom, grid::Wall::free}}};
    setup.materials = {material.create()};
    setup.filling.material_at = [this](const Vector<2>& x) {
      const double y = x[1] - base_height();
      return x[0] < width && y > 0.0 && y < height() ? std::optional(0) : std::nullopt;
    };
    setup.gravity = {0.0, -gravity};
    return setup;
  }
};

/// The outline of the heap: where it ends, and how high it is in its middle.
struct Outline {
  double front, height;  ///< m
};

/// Follows the kinetic energy, by which the heap comes to rest.
class Energy : public run::Observer<2> {
 public:
  void after_step(const run::Moment<2>& now) override {
    kinetic = now.simulation.kinetic_energy();
    m_largest = std::max(m_largest, kinetic);
  }
  void persist(Archive& archive) override {
    archive("kinetic", kinetic);
    archive("largest", m_largest);
  }
  bool has_peaked() const { return kinetic < 0.1 * m_largest; }

  double kinetic = 0.0;  ///< J/m

 private:
  double m_largest = 0.0;
};

/// A column of dry sand in plane strain is let go on a rough base and runs out to both sides; one
/// half is modelled. Measured in channels: (l_end - l0)/l0 = 1.2 a for a = h0/l0 < 2.3, whatever
/// the sand (Lube, Huppert, Sparks & Freundt 2005; Lajeunesse, Monnier & Homsy 2005).
class Collapse : public GridCase<2> {
 public:
  void declare(options::OptionSet& options) override { m_column.declare(options); }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("ran out by {:.4g} widths, measured {:.4g}; height at rest {:.4g} widths",
                       summary.number("run_out"), summary.number("run_out_measured"),
                       summary.number("final_height_over_width"));
  }

 private:
  const run::RunOptions& run_options() const override { return m_column.run; }
  run::Problem<2> problem() override;
  void evaluate(run::Run<2>& run, io::Summary& summary) override;
  run::HistoryTable<2> history();
  std::vector<double> thickness(const solver::Simulation<2>& simulation) const;
  Outline outline(const solver::Simulation<2>& simulation) const;
  double density() const { return m_column.material.parameters().elastic.density; }
  /// Weight times half the height, J/m.
  double energy_scale(const solver::Simulation<2>& simulation) const {
    return 0.5 * simulation.total_mass() * m_column.gravity * m_column.height();
  }
  double share_done(const run::Moment<2>& now) const;

  CollapseOptions m_column;
  std::shared_ptr<Energy> m_energy;
};

run::Problem<2> Collapse::problem() {
  m_energy = std::make_shared<Energy>();
  run::Problem<2> problem{.setup = m_column.setup()};
  const double weight = density() * m_column.gravity;
  problem.initial_stress = [this, weight](const Vector<2>& x) {
    const double vertical = -weight * (m_column.base_height() + m_column.height() - x[1]);
    return SymmetricTensor{{m_column.K0 * vertical, vertical, m_column.K0 * vertical, 0, 0, 0}};
  };
  // Touching nodes are those at or below the base.
  if (m_column.base == Base::frictional)
    problem.constraints = {[this](const solver::Simulation<2>& simulation) {
      return contact_of(
          simulation, ground(m_column.base_height()),
          {.gap_cells = 0.01, .friction = m_column.friction, .reference_density = density()});
    }};
  problem.stages = {{.name = "collapse",
                     .ending = std::make_shared<run::When<2>>(
                         [this](const run::Moment<2>& now) { return share_done(now); })}};
  problem.observers = {m_energy, std::make_shared<run::History<2>>(history())};
  problem.writes_fields_at_start = true;
  return problem;
}

double Collapse::share_done(const run::Moment<2>& now) const {
  const double rest = m_column.rest_tolerance * energy_scale(now.simulation);
  if (m_energy->has_peaked() && m_energy->kinetic < rest) return 1.0;
  return now.clock.time / (longest * m_column.time_scale());
}

run::HistoryTable<2> Collapse::history() {
  const auto by_time =
      run::Cadence<2>::apart(m_column.time_scale() / rows_per_time,
                             [](const run::Moment<2>& now) { return now.clock.time; });
  return {.path = path("history.csv"),
          .columns = {"time_s", "front_m", "height_m", "run_out", "kinetic_energy_J_per_m"},
          .row =
              [this](const run::Moment<2>& now) {
                const Outline heap = outline(now.simulation);
                return std::vector<double>{now.clock.time, heap.front, heap.height,
                                           heap.front / m_column.width - 1.0, m_energy->kinetic};
              },
          .cadence = by_time.or_every(m_column.run.history_every),
          .has_first_row = true,
          .has_last_row = true,
          .has_ledger = true};
}

/// Of the sand as it was packed at the start, over each column of cells, m.
std::vector<double> Collapse::thickness(const solver::Simulation<2>& simulation) const {
  const basis::KnotLines& lines = simulation.grid().nodes(0).lines;
  std::vector<double> columns(static_cast<std::size_t>(lines.cells()), 0.0);
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    columns[static_cast<std::size_t>(lines.cell_of(view.position[0][p]))] +=
        view.mass[p] / (density() * m_column.cell());
  simulation.communicator().sum(columns);
  return columns;
}

/// The heap ends with the first column of cells, from its middle outwards, in which it is thinner
/// than half a cell; that column counts with the share it has. Single grains ahead do not count.
Outline Collapse::outline(const solver::Simulation<2>& simulation) const {
  const std::vector<double> columns = thickness(simulation);
  const double least = front_thickness * m_column.cell();
  const auto end =
      std::find_if(columns.begin(), columns.end(), [&](double t) { return t < least; });
  const double share = end == columns.end() ? 0.0 : *end / least;
  return {(static_cast<double>(end - columns.begin()) + share) * m_column.cell(), columns.front()};
}

void Collapse::evaluate(run::Run<2>& run, io::Summary& summary) {
  const Outline end = outline(run.simulation());
  const double run_out = end.front / m_column.width - 1.0;
  const double measured = run_out_per_aspect_ratio * m_column.aspect_ratio;
  summary.set("run_out", run_out);
  summary.set("run_out_measured", measured);
  summary.set("error_run_out", run_out / measured - 1.0);
  summary.set("final_height_over_width", end.height / m_column.width);
  summary.set("kinetic_energy_share_at_end", m_energy->kinetic / energy_scale(run.simulation()));
}

}  // namespace

std::unique_ptr<Case> make_collapse() {
  return std::make_unique<Collapse>();
}

}  // namespace mpm::cases
