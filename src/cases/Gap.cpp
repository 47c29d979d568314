#include <fmt/format.h>

#include <cmath>

#include "mpm/cases/ContactDetection.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

enum class Shape { block, circle };

/// Follows the gap of a body in free flight, and the force of the plane.
class Approach : public run::Observer<2> {
 public:
  /// Gap in cells, velocity in m/s, cell in m.
  Approach(std::shared_ptr<contact::RigidBody<2>> plane, double first_gap, double velocity,
           double cell)
      : gap(first_gap), m_plane(std::move(plane)), m_velocity(velocity), m_cell(cell) {}

  void after_step(const run::Moment<2>& now) override {
    force = -m_plane->meter().take_mean().force[1];
    gap_before = gap;
    // The contact has looked at the positions before they moved.
    if (force == 0.0) gap -= m_velocity * now.clock.dt / m_cell;
  }
  void persist(Archive& archive) override {
    archive("gap", gap);
    archive("gap_before", gap_before);
    archive("force", force);
  }

  double gap, gap_before = 0.0;  ///< cells, now and at the beginning of the last step
  double force = 0.0;            ///< on the body, N/m

 private:
  std::shared_ptr<contact::RigidBody<2>> m_plane;
  double m_velocity, m_cell;
};

/// An elastic body without stress moves towards a rigid plane at a constant velocity. Exact: free
/// flight, and the first contact force when the gap is closed. The plane lies a share of a cell
/// above a grid line.
class Gap : public GridCase<2> {
 public:
  Gap() {
    m_options.output_dir = "out/gap";
    m_options.largest_courant = 0.5;
    m_material.parameters() = {.youngs_modulus = 2e6, .poisson_ratio = 0.3, .density = 1900.0};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Gap");
    options.choice("body", m_shape, {{"block", Shape::block}, {"circle", Shape::circle}},
                   {"", "shape of the elastic body", "chosen"});
    options.integer("cells", m_cells, {4, 1000}, {"1", "cells over the body's height", "chosen"});
    options.real("offset", m_offset, options::between(0.0, 1.0),
                 {"cells", "height of the plane above a grid line", "chosen"});
    options.real("velocity", m_velocity, options::positive(),
                 {"m/s", "of the body towards the plane", "chosen"});
    declare_detection(options, m_detection, m_gap_cells);
    m_material.declare(options);
  }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("error_gap_cells").empty()) return "no contact";
    return fmt::format("first contact force {:.4f} cells after the gap is closed",
                       summary.number("error_gap_cells"));
  }

 private:
  static constexpr double height = 1.0;       // m, side or diameter of the body
  static constexpr int cells_below = 5;       // of the plane's grid line
  static constexpr int cells_between = 4;     // from there to the body, more than any support
  static constexpr double overrun = 2.0;      // cells past the plane at which the run gives up
  static constexpr double resolution = 0.01;  // cells of travel per step, at most

  double cell() const { return height / static_cast<double>(m_cells); }
  double plane_height() const { return (cells_below + m_offset) * cell(); }
  double body_bottom() const { return (cells_below + cells_between) * cell(); }

  run::Problem<2> problem() override {
    m_plane = ground(plane_height());
    m_approach = std::make_shared<Approach>(m_plane, cells_between - m_offset, m_velocity, cell());
    run::Problem<2> problem{.setup = setup()};
    problem.arrange = [this](solver::Simulation<2>& simulation) {
      const auto view = simulation.particles().view();
      std::fill_n(view.velocity[1], view.count, -m_velocity);
    };
    problem.bodies = {m_plane};
    problem.constraints = {[this](const auto& simulation) { return make_contact(simulation); }};
    problem.stages = {{.name = "approach",
                       .ending = std::make_shared<run::When<2>>(
                           [this](const run::Moment<2>&) { return share_done(); }),
                       .longest_step = resolution * cell() / m_velocity}};
    problem.observers = {m_approach, std::make_shared<run::History<2>>(history())};
    return problem;
  }

  double share_done() const {
    if (m_approach->force > 0.0) return 1.0;
    return 1.0 - (m_approach->gap + overrun) / (cells_between + overrun);
  }

  run::HistoryTable<2> history() const {
    return {
        .path = path("history.csv"),
        .columns = {"time_s", "gap_cells", "contact_force_N_per_m"},
        .row =
            [this](const run::Moment<2>& now) {
              return std::vector<double>{now.clock.time, m_approach->gap_before, m_approach->force};
            },
        .cadence = run::Cadence<2>(1)};
  }

  void evaluate(run::Run<2>&, io::Summary& summary) override {
    if (m_approach->force != 0.0) summary.set("error_gap_cells", -m_approach->gap);
  }

  std::shared_ptr<grid::Constraint<2>> make_contact(const solver::Simulation<2>& simulation) const {
    const double spacing = 0.5 * cell();
    return contact_of(simulation, m_plane,
                      {.detection = m_detection,
                       .gap_cells = m_gap_cells,
                       .reference_density = m_material.parameters().density},
                      {points_behind_plane(simulation.grid(), spacing), spacing * spacing});
  }

  static std::vector<Vector<2>> points_behind_plane(const grid::Grid<2>& grid, double spacing) {
    const int across = static_cast<int>(std::round(grid.nodes(0).lines.end() / spacing));
    std::vector<Vector<2>> points;
    for (int j = 0; j < 2 * (cells_below - 1); ++j)
      for (int i = 0; i < across; ++i)
        points.push_back({(i + 0.5) * spacing, -(j + 0.5) * spacing});
    return points;
  }

  solver::SimulationSetup<2> setup() const {
    const int cells_x = static_cast<int>(m_cells) + 8;
    const int cells_y = static_cast<int>(m_cells) + cells_below + cells_between + 4;
    solver::SimulationSetup<2> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells_x * cell(), cells_x),
                  basis::KnotLines::uniform(0.0, cells_y * cell(), cells_y)}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    if (contact::detection_kinds()[m_detection].is_by_springs())
      setup.particle_contacts = {"contact"};
    setup.materials = {m_material.create()};
    const Vector<2> centre{0.5 * cells_x * cell(), body_bottom() + 0.5 * height};
    setup.filling.material_at = [this, centre](const Vector<2>& x) {
      const double across = x[0] - centre[0], up = x[1] - centre[1];
      const double reach = m_shape == Shape::circle ? std::hypot(across, up)
                                                    : std::max(std::abs(across), std::abs(up));
      return reach < 0.5 * height ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  std::shared_ptr<contact::RigidBody<2>> m_plane;
  std::shared_ptr<Approach> m_approach;
  Shape m_shape = Shape::block;
  std::size_t m_detection = contact::detection_named("particle");
  double m_gap_cells = 0.6;
  std::int64_t m_cells = 20;
  double m_offset = 0.0;
  double m_velocity = 0.5;
  mutable material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Case> make_gap() {
  return std::make_unique<Gap>();
}

}  // namespace mpm::cases
