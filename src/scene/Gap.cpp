#include <fmt/format.h>

#include <cmath>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/ContactDetection.hpp"
#include "mpm/scene/RigidContactOf.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

enum class Shape { block, circle };

/// An elastic body without stress moves towards a rigid plane at a constant velocity. Exact: free
/// flight, and the first contact force when the gap is closed. The plane lies a share of a cell
/// above a grid line.
class Gap : public Scene {
 public:
  Gap() {
    m_run.output_dir = "out/gap";
    m_run.largest_courant = 0.5;
    m_material.parameters() = {.youngs_modulus = 2e6, .poisson_ratio = 0.3, .density = 1900.0};
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
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

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    solver::Simulation<2> simulation(setup());
    const auto contact = make_contact(simulation);
    simulation.add_constraint(contact);
    throw_down(simulation);
    RunLoop<2> loop(m_run, simulation);
    approach(*contact, loop, summary);
    loop.write_fields();
    loop.summarise(summary);
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

  void throw_down(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) view.velocity[1][p] = -m_velocity;
  }

  std::shared_ptr<contact::RigidContact<2>> make_contact(
      const solver::Simulation<2>& simulation) const {
    auto contact = contact_of(simulation, ground(plane_height()),
                              {.detection = m_detection,
                               .gap_cells = m_gap_cells,
                               .reference_density = m_material.parameters().density});
    const double spacing = 0.5 * cell();
    contact->discretise(points_behind_plane(simulation.grid(), spacing), spacing * spacing);
    return contact;
  }

  static std::vector<Vector<2>> points_behind_plane(const grid::Grid<2>& grid, double spacing) {
    const int across = static_cast<int>(std::round(grid.nodes(0).lines.end() / spacing));
    std::vector<Vector<2>> points;
    for (int j = 0; j < 2 * (cells_below - 1); ++j)
      for (int i = 0; i < across; ++i)
        points.push_back({(i + 0.5) * spacing, -(j + 0.5) * spacing});
    return points;
  }

  void approach(contact::RigidContact<2>& contact, RunLoop<2>& loop, io::Summary& summary) const {
    io::CsvFile history(m_run.output_dir + "/history.csv",
                        {"time_s", "gap_cells", "contact_force_N_per_m", "dt_s", "step"});
    double gap = cells_between - m_offset, force = 0.0;
    loop.run(
        {.name = "approach",
         .share_done =
             [&] { return force > 0.0 ? 1.0 : 1.0 - (gap + overrun) / (cells_between + overrun); },
         .after_step =
             [&] {
               const run::Clock& clock = loop.clock();
               force = -petsc::sum(contact.body().meter().take_impulse()[1]) / clock.momentum_dt;
               if (force != 0.0) summary.set("error_gap_cells", -gap);
               history.row({clock.time, gap, force, clock.dt, static_cast<double>(clock.step)});
               // The contact has looked at the positions before they moved.
               if (force == 0.0) gap -= m_velocity * clock.dt / cell();
             },
         .longest_step = resolution * cell() / m_velocity});
  }

  solver::SimulationSetup<2> setup() const {
    const int cells_x = static_cast<int>(m_cells) + 8;
    const int cells_y = static_cast<int>(m_cells) + cells_below + cells_between + 4;
    solver::SimulationSetup<2> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells_x * cell(), cells_x),
                  basis::KnotLines::uniform(0.0, cells_y * cell(), cells_y)}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    setup.materials = {m_material.create()};
    const Vector<2> centre{0.5 * cells_x * cell(), body_bottom() + 0.5 * height};
    setup.filling = {
        [this, centre](const Vector<2>& x) {
          const double across = x[0] - centre[0], up = x[1] - centre[1];
          const double reach = m_shape == Shape::circle ? std::hypot(across, up)
                                                        : std::max(std::abs(across), std::abs(up));
          return reach < 0.5 * height ? std::optional(0) : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  run::RunOptions m_run;
  Shape m_shape = Shape::block;
  contact::Detection m_detection = contact::Detection::particle;
  double m_gap_cells = 0.6;
  std::int64_t m_cells = 20;
  double m_offset = 0.0;
  double m_velocity = 0.5;
  mutable material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Scene> make_gap() {
  return std::make_unique<Gap>();
}

}  // namespace mpm::scene
