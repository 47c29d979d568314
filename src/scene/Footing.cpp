#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/VonMises.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/Ramp.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

enum class Base { rough, smooth };

/// A rigid strip footing on the nodes under it: they take its velocity, all of it where the base is
/// rough, the vertical part where it is smooth.
class NodalFooting : public grid::Constraint<2> {
 public:
  NodalFooting(Base base, double half_width) : m_base(base), m_half_width(half_width) {}

  void constrain(const grid::Grid<2>& grid, grid::ConstrainedNodes<2>& nodes) override {
    grid.for_each_owned_node([&](int I, const auto& node) {
      const Vector<2> x = grid.position(node);
      if (x[0] < 0.0 || x[0] > m_half_width || x[1] < level - round_off) return;
      nodes.set_velocity(I, 1, velocity);
      if (m_base == Base::rough) nodes.set_velocity(I, 0, 0.0);
    });
  }

  bool spares_from_damping() const override { return true; }

  /// Upward impulse of the soil on the half footing since the last call, N s/m. Collective.
  double take_impulse() { return petsc::sum(-booking().take_impulse()[1]); }

  double level = 0.0;     ///< height of the footing's base, m
  double velocity = 0.0;  ///< upward, m/s

 private:
  static constexpr double round_off = 1e-9;  // m, of a node's position

  Base m_base;
  double m_half_width;
};

/// A rigid strip footing is pushed slowly into weightless clay, plane strain, half of it by
/// symmetry. Exact (Prandtl 1920), rough or smooth, for small settlement: it carries (2 + pi) c.
/// Von Mises' solid shears at sigma_1 - sigma_3 = 2 c in plane strain, as Tresca's does. The
/// footing counts to half a cell beyond the last column of nodes it holds.
class Footing : public Scene {
 public:
  Footing() {
    m_run.output_dir = "out/footing";
    m_run.largest_courant = 0.7;
    m_material.parameters() = {
        .elastic = {.youngs_modulus = 20e6, .poisson_ratio = 0.3, .density = 1800.0},
        .shear_strength = 10e3};
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Footing");
    options.integer("cells", m_cells, {2, 1000},
                    {"1", "columns of nodes that half the footing holds", "chosen"});
    options.choice("base", m_base, {{"rough", Base::rough}, {"smooth", Base::smooth}},
                   {"", "whether the footing keeps the soil from sliding", "chosen"});
    options.real("footing_width", m_width, options::positive(), {"m", "B", "chosen"});
    options.real("footing_velocity", m_velocity, options::positive(),
                 {"m/s", "downward, after the first tenth of the way", "chosen"});
    options.real("footing_settlement", m_settlement, options::between(0.0, 1.0),
                 {"B", "at the end", "chosen: the plateau is reached at half of it"});
    options.real("footing_domain_width", m_domain_width, {.minimum = 3.0, .maximum = 100.0},
                 {"B/2", "from the axis to the side wall; the mechanism reaches to 3", "chosen"});
    options.real("footing_domain_depth", m_domain_depth, {.minimum = 1.5, .maximum = 100.0},
                 {"B/2", "to the fixed bottom; the mechanism reaches to 1.41", "chosen"});
    options.real("damping", m_damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
                 {"1", "local damping, f -= damping |f| sign(v)", "chosen"});
    m_material.declare(options);
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    solver::Simulation<2> simulation(setup());
    const auto footing = std::make_shared<NodalFooting>(m_base, half_width());
    simulation.add_constraint(footing);
    simulation.set_damping(m_damping);
    RunLoop<2> loop(m_run, simulation);
    const std::vector<Row> rows = push(simulation, *footing, loop);
    loop.write_fields();
    loop.summarise(summary);
    report(rows, summary);
  }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("error_bearing_capacity").empty()) return "ended before the plateau";
    return fmt::format("bearing capacity {:.4f} c, exact {:.4f} c",
                       summary.number("capacity_over_c"), exact_capacity);
  }

 private:
  struct Row {
    double settlement;  ///< B
    double pressure;    ///< c
  };

  static constexpr double exact_capacity = 2.0 + std::numbers::pi;  // c
  static constexpr double ramp_share = 0.1;     // of the way, over which the velocity rises
  static constexpr double plateau_share = 0.8;  // of the way, after which the plateau counts
  static constexpr int rows_of_history = 200;
  static constexpr int cells_above = 5;  // room for heave

  double half_width() const { return 0.5 * m_width; }
  double cell() const { return half_width() / (static_cast<double>(m_cells) - 0.5); }
  double strength() const { return m_material.parameters().shear_strength; }

  std::vector<Row> push(solver::Simulation<2>& simulation, NodalFooting& footing,
                        RunLoop<2>& loop) const {
    io::CsvFile history(m_run.output_dir + "/history.csv",
                        {"time_s", "settlement_over_B", "pressure_over_c", "kinetic_energy_J_per_m",
                         "dt_s", "step"});
    const double way = m_settlement * m_width;
    const Ramp ramp{m_velocity, ramp_share * way};
    std::vector<Row> curve;
    double time = 0.0;
    loop.run({.name = "loading",
              .share_done = [&] { return -footing.level / way + 1e-9; },
              .before_step =
                  [&](double dt) {
                    const run::Clock& clock = loop.clock();
                    footing.velocity = -ramp.at(clock.time + 0.5 * dt);
                  },
              .after_step =
                  [&] {
                    const run::Clock& clock = loop.clock();
                    footing.level += footing.velocity * clock.dt;
                    time += clock.momentum_dt;
                    const double settlement = -footing.level / m_width;
                    if (settlement <
                        m_settlement * static_cast<double>(curve.size() + 1) / rows_of_history)
                      return;
                    const double force = footing.take_impulse() / std::exchange(time, 0.0);
                    curve.push_back({settlement, force / half_width() / strength()});
                    history.row({clock.time, settlement, curve.back().pressure,
                                 simulation.kinetic_energy(), clock.dt,
                                 static_cast<double>(clock.step)});
                  },
              .status =
                  [&] {
                    return fmt::format("q/c {:.3f}", curve.empty() ? 0.0 : curve.back().pressure);
                  }});
    return curve;
  }

  /// Mean pressure between two shares of the way.
  double mean_pressure(const std::vector<Row>& curve, double from, double to) const {
    double sum = 0.0, count = 0.0;
    for (const Row& row : curve) {
      if (row.settlement <= from * m_settlement || row.settlement > to * m_settlement) continue;
      sum += row.pressure;
      count += 1.0;
    }
    return sum / count;
  }

  void report(const std::vector<Row>& curve, io::Summary& summary) const {
    constexpr double beyond_end = 1.1;
    if (curve.size() < rows_of_history - 1) return;
    const double middle = 0.5 * (plateau_share + 1.0);
    const double capacity = mean_pressure(curve, plateau_share, beyond_end);
    const double rise =
        mean_pressure(curve, middle, beyond_end) - mean_pressure(curve, plateau_share, middle);
    summary.set("capacity_over_c", capacity);
    summary.set("error_bearing_capacity", capacity / exact_capacity - 1.0);
    summary.set("plateau_rise", rise / exact_capacity);
  }

  solver::SimulationSetup<2> setup() const {
    const int across = static_cast<int>(std::round(m_domain_width * half_width() / cell()));
    const int down = static_cast<int>(std::round(m_domain_depth * half_width() / cell()));
    solver::SimulationSetup<2> setup{
        .lines = {
            basis::KnotLines::uniform(0.0, across * cell(), across),
            basis::KnotLines::uniform(-down * cell(), cells_above * cell(), down + cells_above)}};
    m_run.apply_to(setup);
    using grid::Wall;
    setup.walls = {{{Wall::symmetry, Wall::roller}, {Wall::fixed, Wall::free}}};
    setup.materials = {m_material.create()};
    setup.filling = {
        [](const Vector<2>& x) { return x[1] < 0.0 ? std::optional(0) : std::nullopt; },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  run::RunOptions m_run;
  Base m_base = Base::rough;
  std::int64_t m_cells = 10;
  double m_width = 2.0;
  double m_velocity = 0.02;
  double m_settlement = 0.02;
  double m_domain_width = 5.0;
  double m_domain_depth = 3.0;
  double m_damping = 0.0;
  mutable material::VonMisesFactory m_material;
};

}  // namespace

std::unique_ptr<Scene> make_footing() {
  return std::make_unique<Footing>();
}

}  // namespace mpm::scene
