#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/InitialStress.hpp"
#include "mpm/scene/Ramp.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

constexpr int the_sand = 0;              // the only material
constexpr double side = 1.0;             // m, of the cube
constexpr double row_spacing = 0.002;    // axial strain between rows of history.csv
constexpr double ramp_strain = 0.001;    // axial strain in which the platen gets to its velocity
constexpr double first_measured = 0.01;  // axial strain from which kinetic energy is compared

/// A smooth platen on the top of the cube: the nodes whose functions reach the top move as in
/// uniform compression, v_y = -V y/L.
class Platen : public grid::Constraint<3> {
 public:
  void constrain(const grid::Grid<3>& grid, grid::ConstrainedNodes<3>& nodes) override {
    const basis::KnotLines& lines = grid.nodes(1).lines;
    const int first = std::min(lines.cell_of(height), lines.cells() - 1);
    grid.for_each_owned_node([&](int I, const auto& node) {
      if (node[1] < first) return;
      const double y = grid.position(node)[1];
      const double change = nodes.set_velocity(I, 1, -velocity * y / height);
      if (nodes.is_momentum_update()) impulse -= change * y / height;
    });
  }

  double height = side;   ///< L, m
  double velocity = 0.0;  ///< V downward, m/s
  double impulse = 0.0;   ///< on the platen by virtual work, this rank's share, N s
};

/// Means over the cube's particles.
struct CubeState {
  double q, p, volume, void_ratio;
  double spread;  ///< largest deviation of a particle's stress from the mean, as a share of p
};

CubeState observe(const solver::Simulation<3>& simulation, particles::StateHandle void_ratio) {
  const auto& particles = simulation.particles();
  const auto view = particles.view();
  SymmetricTensor sum;
  double volume = 0.0, void_volume = 0.0;
  for (int p = 0; p < view.count; ++p) {
    volume += view.volume[p];
    void_volume += view.volume[p] * view[void_ratio][p];
    for (int k = 0; k < SymmetricTensor::size; ++k) sum[k] += view.volume[p] * view.stress[k][p];
  }
  volume = petsc::sum(volume);
  SymmetricTensor mean;
  for (int k = 0; k < SymmetricTensor::size; ++k) mean[k] = petsc::sum(sum[k]) / volume;
  double spread = 0.0;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor difference = -1.0 * mean;
    for (int k = 0; k < SymmetricTensor::size; ++k) difference[k] += view.stress[k][p];
    spread = std::max(spread, norm(difference));
  }
  const double p = -trace(mean) / 3.0;
  return {std::sqrt(1.5) * norm(deviator(mean)), p, volume, petsc::sum(void_volume) / volume,
          petsc::maximum(spread) / p};
}

/// Options of the triaxial scene. The cube stands at the origin, y is its axis.
struct TriaxialOptions {
  run::RunOptions run;
  material::SandFactory sand;
  std::int64_t cells = 1;   ///< per side
  double pressure = 150e3;  ///< Pa
  double strain_end = 0.3;  ///< logarithmic
  double velocity = 0.01;   ///< m/s, downward

  TriaxialOptions() {
    run.output_dir = "out/triaxial";
    run.basis = basis::Kind::linear;
    run.largest_courant = 0.5;
    sand.parameters().cohesion = 0.0;
    sand.parameters().void_ratio = 0.551;
  }

  void declare(options::OptionSet& options) {
    run.declare(options);
    options.section("Triaxial");
    options.integer("cells", cells, {1, 64},
                    {"1", "cells per side; one is enough for linear functions, cubic ones need 4",
                     "paper, section 3.1"});
    options.real("confining_pressure", pressure, options::positive(),
                 {"Pa", "on the sides, and everywhere at the start", "paper, section 3.1"});
    options.real("strain_end", strain_end, {.minimum = 0.0, .maximum = 0.4, .open_minimum = true},
                 {"1", "last axial strain, logarithmic", "chosen"});
    options.real("triaxial_velocity", velocity, options::positive(),
                 {"m/s", "of the top, downward", "chosen: slow"});
    sand.declare(options);
  }

  /// Free sides bulge into half a side of empty cells; a single cell holds all by itself.
  solver::SimulationSetup<3> setup() const {
    const auto n = static_cast<int>(cells);
    const int all = n == 1 ? 1 : n + (n + 1) / 2;
    const basis::KnotLines line = basis::KnotLines::uniform(0.0, side * all / n, all);
    solver::SimulationSetup<3> setup{.lines = {line, line, line}};
    run.apply_to(setup);
    for (auto& direction : setup.walls) direction = {grid::Wall::symmetry, grid::Wall::free};
    setup.materials = {sand.create()};
    setup.filling = {
        [](const Vector<3>& x) {
          return *std::max_element(x.begin(), x.end()) < side ? std::optional(the_sand)
                                                              : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(run.particles_per_cell_direction); }};
    return setup;
  }

  /// A piece of surface before each particle of the two free sides.
  std::vector<particles::SurfacePiece<3>> sides() const {
    const auto n = static_cast<int>(cells * run.particles_per_cell_direction);
    const double spacing = side / n;
    std::vector<particles::SurfacePiece<3>> pieces;
    for (const std::size_t normal : {std::size_t{0}, std::size_t{2}})
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) {
          particles::SurfacePiece<3> piece{{}, {}, {}, pressure};
          piece.anchor[normal] = side - 0.5 * spacing;
          piece.anchor[1] = (j + 0.5) * spacing;
          piece.anchor[2 - normal] = (k + 0.5) * spacing;
          piece.offset[normal] = 0.5 * spacing;
          piece.area[normal] = spacing * spacing;
          pieces.push_back(piece);
        }
    return pieces;
  }

  Ramp ramp() const { return {velocity, ramp_strain * side}; }
};

/// The paper's triaxial element tests (section 3.1) in the whole method: a cube between three
/// symmetry planes, pressed on its two free sides, is compressed from the top.
class TriaxialRun {
 public:
  TriaxialRun(const TriaxialOptions& options, io::Summary& summary);
  void run();

 private:
  struct Row {
    double strain, q, volumetric_strain;
  };

  void after_step();
  void write_row();
  CubeState observe_cube() const { return observe(m_simulation, m_void_ratio); }
  double axial_stress_since_row(const CubeState& cube);
  void compare_with_material_point() const;
  double strain() const { return std::log(side / m_platen->height); }

  const TriaxialOptions& m_options;
  io::Summary& m_summary;
  solver::Simulation<3> m_simulation;
  particles::StateHandle m_void_ratio;
  std::shared_ptr<Platen> m_platen = std::make_shared<Platen>();
  RunLoop<3> m_loop;
  io::CsvFile m_history;
  std::vector<Row> m_rows;
  double m_initial_volume = 0.0;
  double m_time_since_row = 0.0;
  double m_work = 0.0;  ///< of the platen, J
  double m_largest_spread = 0.0;
  double m_largest_kinetic_share = 0.0;
};

TriaxialRun::TriaxialRun(const TriaxialOptions& options, io::Summary& summary)
    : m_options(options),
      m_summary(summary),
      m_simulation(options.setup()),
      m_void_ratio(m_simulation.particles().state(the_sand, "void_ratio")),
      m_loop(options.run, m_simulation),
      m_history(options.run.output_dir + "/history.csv",
                {"axial_strain", "q_Pa", "p_Pa", "volumetric_strain", "void_ratio",
                 "axial_stress_platen_Pa", "stress_spread", "kinetic_energy_J", "dt_s", "step"}) {
  run::prescribe_pressure(m_simulation, options.pressure);
  m_simulation.boundary().add(options.sides());
  m_simulation.add_constraint(m_platen);
  m_initial_volume = observe_cube().volume;
}

void TriaxialRun::run() {
  write_row();
  m_loop.write_fields();
  m_loop.run({.name = "compression",
              .share_done = [&] { return strain() / m_options.strain_end + 1e-9; },
              .before_step =
                  [&](double dt) {
                    const run::Clock& clock = m_loop.clock();
                    m_platen->velocity = m_options.ramp().at(clock.time_in_stage + 0.5 * dt);
                  },
              .after_step = [&] { after_step(); },
              .status = [&] { return fmt::format("q {:.1f} kPa", m_rows.back().q / 1e3); }});
  m_loop.write_fields();
  m_loop.summarise(m_summary);
  m_summary.set("stress_spread_max", m_largest_spread);
  m_summary.set("kinetic_energy_over_work_max", m_largest_kinetic_share);
  if (m_rows.size() > 1) compare_with_material_point();
}

void TriaxialRun::after_step() {
  const run::Clock& clock = m_loop.clock();
  m_platen->height -= m_platen->velocity * clock.dt;
  m_time_since_row += clock.momentum_dt;
  if (strain() >= row_spacing * static_cast<double>(m_rows.size())) write_row();
}

/// Mean over the interval since the last row; the confining pressure before the first step.
double TriaxialRun::axial_stress_since_row(const CubeState& cube) {
  const double impulse = petsc::sum(std::exchange(m_platen->impulse, 0.0));
  const double seconds = std::exchange(m_time_since_row, 0.0);
  if (seconds == 0.0) return m_options.pressure;
  return impulse / seconds / (cube.volume / m_platen->height);
}

void TriaxialRun::write_row() {
  const CubeState cube = observe_cube();
  const run::Clock& clock = m_loop.clock();
  const double axial_stress = axial_stress_since_row(cube);
  const double volumetric = -std::log(cube.volume / m_initial_volume);
  const double before = m_rows.empty() ? 0.0 : m_rows.back().strain;
  const double kinetic = m_simulation.kinetic_energy();
  m_work += axial_stress * cube.volume * (strain() - before);
  m_largest_spread = std::max(m_largest_spread, cube.spread);
  if (strain() >= first_measured)
    m_largest_kinetic_share = std::max(m_largest_kinetic_share, kinetic / m_work);
  m_rows.push_back({strain(), cube.q, volumetric});
  m_history.row({strain(), cube.q, cube.p, volumetric, cube.void_ratio, axial_stress, cube.spread,
                 kinetic, clock.dt, static_cast<double>(clock.step)});
}

/// The same test at a single point without grid, interpolated to the strains of the rows.
void TriaxialRun::compare_with_material_point() const {
  const auto curve = material::run_element_test(*m_simulation.particles().materials()[0],
                                                {.confining_pressure = m_options.pressure,
                                                 .strain_end = m_rows.back().strain,
                                                 .increments = m_rows.size() * 10});
  const auto peak = std::max_element(curve.begin(), curve.end(),
                                     [](const auto& a, const auto& b) { return a.q < b.q; });
  const Row highest = *std::max_element(m_rows.begin(), m_rows.end(),
                                        [](const Row& a, const Row& b) { return a.q < b.q; });
  double error_q = 0.0, error_volume = 0.0;
  for (const Row& row : m_rows) {
    const double place =
        row.strain / curve.back().axial_strain * static_cast<double>(curve.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), curve.size() - 2);
    const double t = place - static_cast<double>(k);
    const double q = (1.0 - t) * curve[k].q + t * curve[k + 1].q;
    const double v = (1.0 - t) * curve[k].volumetric_strain + t * curve[k + 1].volumetric_strain;
    error_q = std::max(error_q, std::abs(row.q - q) / peak->q);
    error_volume = std::max(error_volume, std::abs(row.volumetric_strain - v));
  }
  m_summary.set("q_peak_Pa", highest.q);
  m_summary.set("strain_at_peak", highest.strain);
  m_summary.set("q_end_Pa", m_rows.back().q);
  m_summary.set("q_peak_material_point_Pa", peak->q);
  m_summary.set("error_q", error_q);
  m_summary.set("error_volumetric_strain", error_volume);
}

class Triaxial : public Scene {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void run(io::Summary& summary) override { TriaxialRun(m_options, summary).run(); }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("q_peak_Pa").empty()) return "ended before the first row under load";
    return fmt::format("peak q {:.4g} kPa at strain {:.3g}, {:.2g} % off the material point",
                       summary.number("q_peak_Pa") / 1e3, summary.number("strain_at_peak"),
                       100.0 * summary.number("error_q"));
  }

 private:
  TriaxialOptions m_options;
};

}  // namespace

std::unique_ptr<Scene> make_triaxial() {
  return std::make_unique<Triaxial>();
}

}  // namespace mpm::scene
