#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "mpm/cases/GridCase.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

constexpr int the_sand = 0;              // the only material
constexpr double side = 1.0;             // m, of the cube
constexpr double row_spacing = 0.002;    // axial strain between rows of history.csv
constexpr double ramp_strain = 0.001;    // axial strain in which the platen gets to its velocity
constexpr double first_measured = 0.01;  // axial strain from which kinetic energy is compared

/// A smooth platen on the top of the cube at y = L: the nodes whose functions reach the top move as
/// in uniform compression, v_y = -V y/L.
class Platen : public grid::Constraint<3> {
 public:
  explicit Platen(std::shared_ptr<contact::RigidBody<3>> body) : m_body(std::move(body)) {}

  void constrain(const grid::Grid<3>& grid, grid::ConstrainedNodes<3>& nodes) override {
    const double height = m_body->position[1], velocity = m_body->velocity[1];
    const basis::KnotLines& lines = grid.nodes(1).lines;
    const int first = std::min(lines.cell_of(height), lines.cells() - 1);
    if (nodes.is_momentum_update()) m_time += nodes.dt();
    grid.for_each_owned_node([&](int I, const auto& node) {
      if (node[1] < first) return;
      const double y = grid.position(node)[1];
      const double change = nodes.set_velocity(I, 1, velocity * y / height);
      if (nodes.is_momentum_update()) m_impulse -= change * y / height;
    });
  }

  void persist(Archive& archive) override {
    grid::Constraint<3>::persist(archive);
    archive.sum("virtual_impulse", m_impulse);
    archive("time", m_time);
  }

  /// Mean force on the platen since the last call by virtual work, N; nothing before the first
  /// step. Collective.
  std::optional<double> take_mean_force() {
    const double impulse = petsc::sum(std::exchange(m_impulse, 0.0));
    const double seconds = std::exchange(m_time, 0.0);
    if (seconds == 0.0) return std::nullopt;
    return impulse / seconds;
  }

 private:
  std::shared_ptr<contact::RigidBody<3>> m_body;
  double m_impulse = 0.0;  ///< N s, this rank's share
  double m_time = 0.0;     ///< s
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

/// What the work of the platen and the cube's stresses have come to.
class Compression : public run::Observer<3> {
 public:
  void add(double work, double kinetic_energy, double strain, double spread) {
    m_work += work;
    largest_spread = std::max(largest_spread, spread);
    if (strain >= first_measured)
      largest_kinetic_share = std::max(largest_kinetic_share, kinetic_energy / m_work);
  }
  void persist(Archive& archive) override {
    archive("work", m_work);
    archive("largest_spread", largest_spread);
    archive("largest_kinetic_share", largest_kinetic_share);
    archive("initial_volume", initial_volume);
  }

  double largest_spread = 0.0;         ///< of p
  double largest_kinetic_share = 0.0;  ///< of the work
  double initial_volume = 0.0;         ///< m^3

 private:
  double m_work = 0.0;  ///< J
};

/// The paper's triaxial element tests (section 3.1) in the whole method: a cube between three
/// symmetry planes, pressed on its two free sides, is compressed from the top. The cube stands at
/// the origin, y is its axis.
class Triaxial : public GridCase<3> {
 public:
  Triaxial() {
    m_options.output_dir = "out/triaxial";
    m_options.basis = basis::Kind::linear;
    m_options.largest_courant = 0.5;
    m_sand.parameters().cohesion = 0.0;
    m_sand.parameters().void_ratio = 0.551;
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Triaxial");
    options.integer("cells", m_cells, {1, 64},
                    {"1", "cells per side; one is enough for linear functions, cubic ones need 4",
                     "paper, section 3.1"});
    options.real("confining_pressure", m_pressure, options::positive(),
                 {"Pa", "on the sides, and everywhere at the start", "paper, section 3.1"});
    options.real("strain_end", m_strain_end, {.minimum = 0.0, .maximum = 0.4, .open_minimum = true},
                 {"1", "last axial strain, logarithmic", "chosen"});
    options.real("triaxial_velocity", m_velocity, options::positive(),
                 {"m/s", "of the top, downward", "chosen: slow"});
    m_sand.declare(options);
  }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("q_peak_Pa").empty()) return "ended before the first row under load";
    return fmt::format("peak q {:.4g} kPa at strain {:.3g}, {:.2g} % off the material point",
                       summary.number("q_peak_Pa") / 1e3, summary.number("strain_at_peak"),
                       100.0 * summary.number("error_q"));
  }

 private:
  static constexpr std::size_t strain_column = 0, q_column = 1, volume_column = 3;

  run::Problem<3> problem() override;
  void evaluate(run::Run<3>& run, io::Summary& summary) override;
  void compare_with_material_point(const material::Material& law, io::Summary& summary) const;
  run::HistoryTable<3> history();
  std::vector<double> row(const run::Moment<3>& now);
  double strain() const { return std::log(side / m_platen->position[1]); }

  /// Free sides bulge into half a side of empty cells; a single cell holds all by itself.
  solver::SimulationSetup<3> setup() const {
    const auto n = static_cast<int>(m_cells);
    const int all = n == 1 ? 1 : n + (n + 1) / 2;
    const basis::KnotLines line = basis::KnotLines::uniform(0.0, side * all / n, all);
    solver::SimulationSetup<3> setup{.lines = {line, line, line}};
    m_options.apply_to(setup);
    for (auto& direction : setup.walls) direction = {grid::Wall::symmetry, grid::Wall::free};
    setup.materials = {m_sand.create()};
    setup.filling.material_at = [](const Vector<3>& x) {
      return *std::max_element(x.begin(), x.end()) < side ? std::optional(the_sand) : std::nullopt;
    };
    return setup;
  }

  /// A piece of surface before each particle of the two free sides.
  std::vector<particles::SurfacePiece<3>> sides() const {
    const auto n = static_cast<int>(m_cells * m_options.particles_per_cell_direction);
    const double spacing = side / n;
    std::vector<particles::SurfacePiece<3>> pieces;
    for (const std::size_t normal : {std::size_t{0}, std::size_t{2}})
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k) {
          particles::SurfacePiece<3> piece{{}, {}, {}, m_pressure};
          piece.anchor[normal] = side - 0.5 * spacing;
          piece.anchor[1] = (j + 0.5) * spacing;
          piece.anchor[2 - normal] = (k + 0.5) * spacing;
          piece.offset[normal] = 0.5 * spacing;
          piece.area[normal] = spacing * spacing;
          pieces.push_back(piece);
        }
    return pieces;
  }

  material::SandFactory m_sand;
  std::int64_t m_cells = 1;   ///< per side
  double m_pressure = 150e3;  ///< Pa
  double m_strain_end = 0.3;  ///< logarithmic
  double m_velocity = 0.01;   ///< m/s, downward
  std::shared_ptr<contact::RigidBody<3>> m_platen;
  std::shared_ptr<Platen> m_constraint;
  std::shared_ptr<Compression> m_compression;
  std::shared_ptr<run::History<3>> m_history;
};

run::Problem<3> Triaxial::problem() {
  const contact::Ramp ramp{m_velocity, ramp_strain * side};
  m_platen = std::make_shared<contact::RigidBody<3>>(
      std::make_shared<geometry::HalfSpace<3>>(Vector<3>{0.0, -1.0, 0.0}),
      Vector<3>{0.0, side, 0.0},
      std::make_shared<contact::RampMotion<3>>(Vector<3>{0.0, -1.0, 0.0}, ramp));
  m_constraint = std::make_shared<Platen>(m_platen);
  m_compression = std::make_shared<Compression>();
  m_history = std::make_shared<run::History<3>>(history());
  run::Problem<3> problem{.setup = setup()};
  problem.initial_stress = [pressure = m_pressure](const Vector<3>&) {
    return SymmetricTensor{{-pressure, -pressure, -pressure, 0.0, 0.0, 0.0}};
  };
  problem.loaded_surface = sides();
  problem.bodies = {m_platen};
  problem.constraints = {[this](const auto&) { return m_constraint; }};
  problem.stages = {{.name = "compression",
                     .ending = std::make_shared<run::When<3>>([this](const run::Moment<3>&) {
                       return strain() / m_strain_end + 1e-9;
                     })}};
  problem.observers = {m_compression, m_history};
  problem.writes_fields_at_start = true;
  return problem;
}

run::HistoryTable<3> Triaxial::history() {
  return {
      .path = path("history.csv"),
      .columns = {"axial_strain", "q_Pa", "p_Pa", "volumetric_strain", "void_ratio",
                  "axial_stress_platen_Pa", "stress_spread", "kinetic_energy_J"},
      .row = [this](const run::Moment<3>& now) { return row(now); },
      .cadence = run::Cadence<3>(row_spacing, [this](const run::Moment<3>&) { return strain(); }),
      .status =
          [](const run::History<3>& rows) {
            return fmt::format("q {:.1f} kPa", rows.last(q_column) / 1e3);
          },
      .has_first_row = true,
      .has_ledger = true};
}

/// The platen's stress is a mean over the interval since the last row, the confining pressure
/// before the first step.
std::vector<double> Triaxial::row(const run::Moment<3>& now) {
  const auto& particles = now.simulation.particles();
  const CubeState cube = observe(now.simulation, particles.state(the_sand, "void_ratio"));
  if (m_compression->initial_volume == 0.0) m_compression->initial_volume = cube.volume;
  const auto force = m_constraint->take_mean_force();
  const double stress = force ? *force / (cube.volume / m_platen->position[1]) : m_pressure;
  const double kinetic = now.simulation.kinetic_energy();
  const double before = m_history->last(strain_column);
  m_compression->add(stress * cube.volume * (strain() - before), kinetic, strain(), cube.spread);
  return {
      strain(),        cube.q, cube.p,      -std::log(cube.volume / m_compression->initial_volume),
      cube.void_ratio, stress, cube.spread, kinetic};
}

void Triaxial::evaluate(run::Run<3>& run, io::Summary& summary) {
  summary.set("stress_spread_max", m_compression->largest_spread);
  summary.set("kinetic_energy_over_work_max", m_compression->largest_kinetic_share);
  if (m_history->rows().size() > 1)
    compare_with_material_point(*run.simulation().particles().materials()[the_sand], summary);
}

/// The same test at a single point without grid, interpolated to the strains of the rows.
void Triaxial::compare_with_material_point(const material::Material& law,
                                           io::Summary& summary) const {
  const auto curve = material::run_element_test(law, {.confining_pressure = m_pressure,
                                                      .strain_end = m_history->last(strain_column),
                                                      .increments = m_history->rows().size() * 10});
  const auto peak = std::max_element(curve.begin(), curve.end(),
                                     [](const auto& a, const auto& b) { return a.q < b.q; });
  const auto& rows = m_history->rows();
  const auto highest =
      *std::max_element(rows.begin(), rows.end(),
                        [](const auto& a, const auto& b) { return a[q_column] < b[q_column]; });
  double error_q = 0.0, error_volume = 0.0;
  for (const auto& row : rows) {
    const double place =
        row[strain_column] / curve.back().axial_strain * static_cast<double>(curve.size() - 1);
    const auto k = std::min(static_cast<std::size_t>(place), curve.size() - 2);
    const double t = place - static_cast<double>(k);
    const double q = (1.0 - t) * curve[k].q + t * curve[k + 1].q;
    const double v = (1.0 - t) * curve[k].volumetric_strain + t * curve[k + 1].volumetric_strain;
    error_q = std::max(error_q, std::abs(row[q_column] - q) / peak->q);
    error_volume = std::max(error_volume, std::abs(row[volume_column] - v));
  }
  summary.set("q_peak_Pa", highest[q_column]);
  summary.set("strain_at_peak", highest[strain_column]);
  summary.set("q_end_Pa", m_history->last(q_column));
  summary.set("q_peak_material_point_Pa", peak->q);
  summary.set("error_q", error_q);
  summary.set("error_volumetric_strain", error_volume);
}

}  // namespace

std::unique_ptr<Case> make_triaxial() {
  return std::make_unique<Triaxial>();
}

}  // namespace mpm::cases
