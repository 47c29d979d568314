#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/InitialStress.hpp"
#include "mpm/scene/RigidContactOf.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
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
    setup.filling = {
        [this](const Vector<2>& x) {
          const double y = x[1] - base_height();
          return x[0] < width && y > 0.0 && y < height() ? std::optional(0) : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(run.particles_per_cell_direction); }};
    setup.gravity = {0.0, -gravity};
    return setup;
  }
};

/// The outline of the heap: where it ends, and how high it is in its middle.
struct Outline {
  double front, height;  ///< m
};

/// A column of dry sand in plane strain is let go on a rough base and runs out to both sides; one
/// half is modelled. Measured in channels: (l_end - l0)/l0 = 1.2 a for a = h0/l0 < 2.3, whatever
/// the sand (Lube, Huppert, Sparks & Freundt 2005; Lajeunesse, Monnier & Homsy 2005).
class CollapseRun {
 public:
  CollapseRun(const CollapseOptions& options, io::Summary& summary);
  void run();

 private:
  void stand();
  std::vector<double> thickness() const;
  Outline outline() const;
  void after_step();
  void write_row();
  void conclude();

  const CollapseOptions& m_options;
  io::Summary& m_summary;
  solver::Simulation<2> m_simulation;
  double m_density;  ///< kg/m^3
  RunLoop<2> m_loop;
  io::CsvFile m_history;
  double m_energy_scale = 0.0;  ///< J/m
  double m_kinetic = 0.0, m_largest_kinetic = 0.0;
  double m_next_row = 0.0;  ///< s
};

CollapseRun::CollapseRun(const CollapseOptions& options, io::Summary& summary)
    : m_options(options),
      m_summary(summary),
      m_simulation(options.setup()),
      m_density(m_simulation.particles().materials()[0]->initial_density()),
      m_loop(options.run, m_simulation),
      m_history(
          options.run.output_dir + "/history.csv",
          {"time_s", "front_m", "height_m", "run_out", "kinetic_energy_J_per_m", "dt_s", "step"}) {
  m_energy_scale = 0.5 * m_simulation.total_mass() * options.gravity * options.height();
  if (options.base == Base::frictional) stand();
  const double weight = m_density * options.gravity;
  run::prescribe_stress<2>(m_simulation, [&](const Vector<2>& x) {
    const double vertical = -weight * (options.base_height() + options.height() - x[1]);
    return SymmetricTensor{{options.K0 * vertical, vertical, options.K0 * vertical, 0, 0, 0}};
  });
}

/// Touching nodes are those at or below the base.
void CollapseRun::stand() {
  m_simulation.add_constraint(contact_of(
      m_simulation, ground(m_options.base_height()),
      {.gap_cells = 0.01, .friction = m_options.friction, .reference_density = m_density}));
}

void CollapseRun::run() {
  write_row();
  m_loop.write_fields();
  const run::Clock& clock = m_loop.clock();
  const double last = longest * m_options.time_scale();
  m_loop.run({.name = "collapse",
              .share_done =
                  [&] {
                    const double rest = m_options.rest_tolerance * m_energy_scale;
                    const bool has_peaked = m_kinetic < 0.1 * m_largest_kinetic;
                    if (has_peaked && m_kinetic < rest) return 1.0;
                    return clock.time / last;
                  },
              .after_step = [&] { after_step(); }});
  write_row();
  m_loop.write_fields();
  m_loop.summarise(m_summary);
  conclude();
}

void CollapseRun::after_step() {
  m_kinetic = m_simulation.kinetic_energy();
  m_largest_kinetic = std::max(m_largest_kinetic, m_kinetic);
  const run::Clock& clock = m_loop.clock();
  const long long every = m_options.run.history_every;
  if (every > 0 ? clock.step % every == 0 : clock.time >= m_next_row) write_row();
}

/// Of the sand as it was packed at the start, over each column of cells, m.
std::vector<double> CollapseRun::thickness() const {
  const double h = m_options.cell();
  std::vector<double> columns(static_cast<std::size_t>(m_simulation.grid().nodes(0).lines.cells()),
                              0.0);
  const auto view = m_simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    columns[static_cast<std::size_t>(m_simulation.grid().nodes(0).lines.cell_of(
        view.position[0][p]))] += view.mass[p] / (m_density * h);
  MPI_Allreduce(MPI_IN_PLACE, columns.data(), static_cast<int>(columns.size()), MPI_DOUBLE, MPI_SUM,
                PETSC_COMM_WORLD);
  return columns;
}

/// The heap ends with the first column of cells, from its middle outwards, in which it is thinner
/// than half a cell; that column counts with the share it has. Single grains ahead do not count.
Outline CollapseRun::outline() const {
  const std::vector<double> columns = thickness();
  const double least = front_thickness * m_options.cell();
  const auto end =
      std::find_if(columns.begin(), columns.end(), [&](double t) { return t < least; });
  const double share = end == columns.end() ? 0.0 : *end / least;
  return {(static_cast<double>(end - columns.begin()) + share) * m_options.cell(), columns.front()};
}

void CollapseRun::write_row() {
  const run::Clock& clock = m_loop.clock();
  const Outline now = outline();
  m_next_row = clock.time + m_options.time_scale() / rows_per_time;
  m_history.row({clock.time, now.front, now.height, now.front / m_options.width - 1.0, m_kinetic,
                 clock.dt, static_cast<double>(clock.step)});
}

void CollapseRun::conclude() {
  const Outline end = outline();
  const double run_out = end.front / m_options.width - 1.0;
  m_summary.set("run_out", run_out);
  m_summary.set("run_out_measured", run_out_per_aspect_ratio * m_options.aspect_ratio);
  m_summary.set("error_run_out",
                run_out / (run_out_per_aspect_ratio * m_options.aspect_ratio) - 1.0);
  m_summary.set("final_height_over_width", end.height / m_options.width);
  m_summary.set("kinetic_energy_share_at_end", m_kinetic / m_energy_scale);
}

class Collapse : public Scene {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void run(io::Summary& summary) override { CollapseRun(m_options, summary).run(); }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("ran out by {:.4g} widths, measured {:.4g}; height at rest {:.4g} widths",
                       summary.number("run_out"), summary.number("run_out_measured"),
                       summary.number("final_height_over_width"));
  }

 private:
  CollapseOptions m_options;
};

}  // namespace

std::unique_ptr<Scene> make_collapse() {
  return std::make_unique<Collapse>();
}

}  // namespace mpm::scene
