#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mpm/cases/GridCase.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/material/VonMises.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

enum class Base { rough, smooth };

/// A rigid strip footing on the nodes under it: they take its velocity, all of it where the base is
/// rough, the vertical part where it is smooth. Its reference point is at its base.
class NodalFooting : public grid::Constraint<2> {
 public:
  NodalFooting(std::shared_ptr<contact::RigidBody<2>> body, Base base, double half_width)
      : m_body(std::move(body)), m_base(base), m_half_width(half_width) {}

  void constrain(const grid::Grid<2>& grid, grid::ConstrainedNodes<2>& nodes) override {
    grid.for_each_owned_node([&](int I, const auto& node) {
      const Vector<2> x = grid.position(node);
      const double level = m_body->position[1];
      if (x[0] < 0.0 || x[0] > m_half_width || x[1] < level - round_off) return;
      nodes.set_velocity(I, 1, m_body->velocity[1]);
      if (m_base == Base::rough) nodes.set_velocity(I, 0, 0.0);
    });
  }

  bool spares_from_damping() const override { return true; }
  grid::Booking<2>& booking() override { return m_body->meter().booking(); }

 private:
  static constexpr double round_off = 1e-9;  // m, of a node's position

  std::shared_ptr<contact::RigidBody<2>> m_body;
  Base m_base;
  double m_half_width;
};

/// A rigid strip footing is pushed slowly into weightless clay, plane strain, half of it by
/// symmetry. Exact (Prandtl 1920), rough or smooth, for small settlement: it carries (2 + pi) c.
/// Von Mises' solid shears at sigma_1 - sigma_3 = 2 c in plane strain, as Tresca's does. The
/// footing counts to half a cell beyond the last column of nodes it holds.
class Footing : public GridCase<2> {
 public:
  Footing() {
    m_options.output_dir = "out/footing";
    m_options.largest_courant = 0.7;
    m_material.parameters() = {
        .elastic = {.youngs_modulus = 20e6, .poisson_ratio = 0.3, .density = 1800.0},
        .shear_strength = 10e3};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
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

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("error_bearing_capacity").empty()) return "ended before the plateau";
    return fmt::format("bearing capacity {:.4f} c, exact {:.4f} c",
                       summary.number("capacity_over_c"), exact_capacity);
  }

 private:
  static constexpr double exact_capacity = 2.0 + std::numbers::pi;  // c
  static constexpr double ramp_share = 0.1;     // of the way, over which the velocity rises
  static constexpr double plateau_share = 0.8;  // of the way, after which the plateau counts
  static constexpr std::size_t settlement_column = 1, pressure_column = 2;
  static constexpr int rows_of_history = 200;
  static constexpr int cells_above = 5;  // room for heave

  double half_width() const { return 0.5 * m_width; }
  double cell() const { return half_width() / (static_cast<double>(m_cells) - 0.5); }
  double strength() const { return m_material.parameters().shear_strength; }

  double way() const { return m_settlement * m_width; }

  run::Problem<2> problem() override {
    m_footing = std::make_shared<contact::RigidBody<2>>(
        std::make_shared<geometry::HalfSpace<2>>(Vector<2>{0.0, -1.0}), Vector<2>{0.0, 0.0},
        std::make_shared<contact::RampMotion<2>>(Vector<2>{0.0, -1.0},
                                                 contact::Ramp{m_velocity, ramp_share * way()}));
    m_curve = std::make_shared<run::History<2>>(history());
    run::Problem<2> problem{.setup = setup()};
    problem.bodies = {m_footing};
    problem.constraints = {[this](const auto&) {
      return std::make_shared<NodalFooting>(m_footing, m_base, half_width());
    }};
    problem.stages = {{.name = "loading",
                       .ending = std::make_shared<run::When<2>>([this](const run::Moment<2>&) {
                         return -m_footing->position[1] / way() + 1e-9;
                       }),
                       .damping = m_damping}};
    problem.observers = {m_curve};
    return problem;
  }

  run::HistoryTable<2> history() const {
    return {.path = path("history.csv"),
            .columns = {"time_s", "settlement_over_B", "pressure_over_c", "kinetic_energy_J_per_m"},
            .row =
                [this](const run::Moment<2>& now) {
                  const double force = m_footing->meter().take_mean().force[1];
                  return std::vector<double>{now.clock.time, -m_footing->position[1] / m_width,
                                             force / half_width() / strength(),
                                             now.simulation.kinetic_energy()};
                },
            .cadence = run::Cadence<2>(
                m_settlement / rows_of_history,
                [this](const run::Moment<2>&) { return -m_footing->position[1] / m_width; }),
            .status =
                [](const run::History<2>& rows) {
                  return fmt::format("q/c {:.3f}", rows.last(pressure_column));
                },
            .has_ledger = true};
  }

  /// Mean pressure between two shares of the way.
  double mean_pressure(double from, double to) const {
    double sum = 0.0, count = 0.0;
    for (const auto& row : m_curve->rows()) {
      const double settlement = row[settlement_column];
      if (settlement <= from * m_settlement || settlement > to * m_settlement) continue;
      sum += row[pressure_column];
      count += 1.0;
    }
    return sum / count;
  }

  void evaluate(run::Run<2>&, io::Summary& summary) override {
    constexpr double beyond_end = 1.1;
    if (m_curve->rows().size() < rows_of_history - 1) return;
    const double middle = 0.5 * (plateau_share + 1.0);
    const double capacity = mean_pressure(plateau_share, beyond_end);
    const double rise = mean_pressure(middle, beyond_end) - mean_pressure(plateau_share, middle);
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
    m_options.apply_to(setup);
    using grid::Wall;
    setup.walls = {{{Wall::symmetry, Wall::roller}, {Wall::fixed, Wall::free}}};
    setup.materials = {m_material.create()};
    setup.filling.material_at = [](const Vector<2>& x) {
      return x[1] < 0.0 ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  std::shared_ptr<contact::RigidBody<2>> m_footing;
  std::shared_ptr<run::History<2>> m_curve;
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

std::unique_ptr<Case> make_footing() {
  return std::make_unique<Footing>();
}

}  // namespace mpm::cases
