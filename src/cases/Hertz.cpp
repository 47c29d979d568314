#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/cases/ContactDetection.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

/// A rigid plane that remembers how much of its force each column of nodes has taken.
class RecordedPlane : public grid::Constraint<2> {
 public:
  RecordedPlane(const grid::Grid<2>& grid, std::shared_ptr<grid::Constraint<2>> contact)
      : m_contact(std::move(contact)),
        m_columns(static_cast<std::size_t>(grid.local_size())),
        m_impulse(grid.nodes(0).positions.size(), 0.0) {}

  void look_at_particles(double dt) override { m_contact->look_at_particles(dt); }
  void find_nodes() override { m_contact->find_nodes(); }
  bool spares_from_damping() const override { return true; }
  grid::Booking<2>& booking() override { return m_contact->booking(); }

  void constrain(const grid::Grid<2>& grid, grid::ConstrainedNodes<2>& nodes) override {
    m_contact->constrain(grid, nodes);
    if (!nodes.is_momentum_update()) return;
    m_time += nodes.dt();
    m_columns.assign(static_cast<std::size_t>(grid.local_size()), 0);
    grid.for_each_owned_node([&](int I, const auto& node) {
      m_columns[static_cast<std::size_t>(I)] = static_cast<std::size_t>(node[0]);
    });
    for (const auto& [I, given] : booking().changes)
      m_impulse[m_columns[static_cast<std::size_t>(I)]] += given[1];
  }

  /// Takes the mean force of each column since the last call, N/m. Collective.
  void take_forces() {
    m_forces.clear();
    for (double& impulse : m_impulse)
      m_forces.push_back(petsc::sum(std::exchange(impulse, 0.0)) / m_time);
    m_time = 0.0;
  }
  const std::vector<double>& forces() const { return m_forces; }

  void persist(Archive& archive) override {
    archive.group("contact", [&] { m_contact->persist(archive); });
    archive.sum("column_impulse", m_impulse);
    archive("time", m_time);
    archive("forces", m_forces);
  }

 private:
  std::shared_ptr<grid::Constraint<2>> m_contact;
  std::vector<std::size_t> m_columns;  ///< of the local nodes
  std::vector<double> m_impulse;       ///< N s/m, this rank's share
  double m_time = 0.0;
  std::vector<double> m_forces;  ///< last taken
};

/// The lower half of an elastic cylinder is pressed on a rigid plane without friction by a uniform
/// load q on its flat cut, x symmetric, plane strain, until it is at rest; so are two equal half
/// cylinders pressed together. Exact for small contact widths (Hertz 1881; Johnson 1985, section
/// 4.2): with P = 2 R q and E* = E/(1 - nu^2) the pressure is p0 sqrt(1 - x^2/b^2),
/// p0 = sqrt(P E*/(pi R)), b = 2 P/(pi p0).
class Hertz : public GridCase<2> {
 public:
  Hertz() {
    m_options.output_dir = "out/hertz";
    m_options.largest_courant = 0.9;
    m_material.parameters() = {.youngs_modulus = 200.0, .poisson_ratio = 0.3, .density = 1.0};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Hertz");
    options.integer("cells", m_cells, {8, 10'000}, {"1", "cells over the radius", "chosen"});
    options.real("radius", m_radius, options::positive(), {"m", "of the cylinder", "chosen"});
    options.real("offset", m_offset, options::between(0.0, 1.0),
                 {"cells", "height of the plane above a grid line", "docs/verification/hertz.md"});
    options.real("load", m_load, options::positive(),
                 {"Pa", "q, pressure on the flat cut through the axis", "chosen"});
    options.real("load_time", m_load_time, options::positive(),
                 {"s", "in which the load rises as (1 - cos)/2", "chosen"});
    options.real("damping", m_damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
                 {"1", "local damping, f -= damping |f| sign(v)", "chosen"});
    options.real("rest_tolerance", m_tolerance, options::positive(),
                 {"1", "ends when sum |f| falls below this share of the load", "chosen"});
    declare_detection(options, m_detection, m_gap_cells);
    m_material.declare(options);
  }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("error_contact_pressure").empty()) return "ended before any contact";
    return fmt::format(
        "peak pressure {:.4g} Pa, exact {:.4g} Pa; half width {:.4g} m, exact {:.4g} m",
        summary.number("contact_pressure_peak_Pa"), exact_peak(),
        summary.number("contact_half_width_m"), exact_half_width());
  }

 private:
  static constexpr int cells_below = 5;         // the plane, more than any support
  static constexpr long long check_every = 50;  // steps

  double cell() const { return m_radius / static_cast<double>(m_cells); }
  double plane_height() const { return (m_offset - 1.0) * cell(); }
  double force() const { return 2.0 * m_radius * m_load; }
  double exact_peak() const {
    const auto& law = m_material.parameters();
    const double modulus = law.youngs_modulus / (1.0 - law.poisson_ratio * law.poisson_ratio);
    return std::sqrt(force() * modulus / (std::numbers::pi * m_radius));
  }
  double exact_half_width() const { return 2.0 * force() / (std::numbers::pi * exact_peak()); }
  double exact_pressure(double x) const {
    const double share = x / exact_half_width();
    return share < 1.0 ? exact_peak() * std::sqrt(1.0 - share * share) : 0.0;
  }
  double load_at(double time) const {
    const double share = std::min(1.0, time / m_load_time);
    return 0.5 * m_load * (1.0 - std::cos(std::numbers::pi * share));
  }
  /// Height of the cylinder's surface above the plane.
  double bottom(double x) const { return m_radius - std::sqrt(m_radius * m_radius - x * x); }

  solver::SimulationSetup<2> setup() const {
    const int cells_x = static_cast<int>(m_cells) + 3, cells_y = static_cast<int>(m_cells) + 2;
    solver::SimulationSetup<2> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells_x * cell(), cells_x),
                  basis::KnotLines::uniform(-cells_below * cell(), cells_y * cell(),
                                            cells_y + cells_below)}};
    m_options.apply_to(setup);
    using grid::Wall;
    setup.walls = {{{Wall::symmetry, Wall::free}, {Wall::free, Wall::free}}};
    if (contact::detection_kinds()[m_detection].is_by_springs())
      setup.particle_contacts = {"contact"};
    setup.materials = {m_material.create()};
    setup.filling.material_at = [this](const Vector<2>& x) {
      const bool inside = x[0] < m_radius && x[1] > 0.0 && x[1] < m_radius;
      return inside ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  /// Shortens the columns of the square block to the cylinder: rows of a lattice would end in steps
  /// as high as the gap that contact has to close.
  void round_off_bottom(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const double lowest = bottom(view.position[0][p]);
      const double share = 1.0 - lowest / m_radius;
      view.position[1][p] = plane_height() + lowest + share * view.position[1][p];
      view.volume[p] *= share;
      view.mass[p] *= share;
    }
  }

  /// A piece of surface above each particle of the top row.
  std::vector<particles::SurfacePiece<2>> cut() const {
    const auto columns = static_cast<int>(m_cells * m_options.particles_per_cell_direction);
    const double spacing = m_radius / columns;
    std::vector<particles::SurfacePiece<2>> pieces;
    for (int i = 0; i < columns; ++i) {
      const double x = (i + 0.5) * spacing;
      const double depth = 0.5 * spacing * (1.0 - bottom(x) / m_radius);
      pieces.push_back({.anchor = {x, plane_height() + m_radius - depth},
                        .offset = {0.0, depth},
                        .area = {0.0, spacing},
                        .pressure = 0.0});
    }
    return pieces;
  }

  std::shared_ptr<RecordedPlane> make_plane(const solver::Simulation<2>& simulation) const {
    auto contact = contact_of(simulation, m_body,
                              {.detection = m_detection,
                               .gap_cells = m_gap_cells,
                               .reference_density = m_material.parameters().density},
                              {points_behind_plane(), 0.25 * cell() * cell()});
    return std::make_shared<RecordedPlane>(simulation.grid(), std::move(contact));
  }

  std::vector<Vector<2>> points_behind_plane() const {
    const double spacing = 0.5 * cell();
    std::vector<Vector<2>> points;
    for (int j = 0; j < 2 * (cells_below - 2); ++j)
      for (int i = 0; i < 2 * static_cast<int>(m_cells); ++i)
        points.push_back({(i + 0.5) * spacing, -(j + 0.5) * spacing});
    return points;
  }

  run::Problem<2> problem() override {
    m_body = ground(plane_height());
    run::Problem<2> problem{.setup = setup()};
    problem.arrange = [this](solver::Simulation<2>& simulation) { round_off_bottom(simulation); };
    problem.loaded_surface = cut();
    problem.surface_pressure = [this](double time) { return load_at(time); };
    problem.bodies = {m_body};
    problem.constraints = {[this](const auto& simulation) {
      m_plane = make_plane(simulation);
      return m_plane;
    }};
    problem.stages = {{.name = "loading",
                       .ending = std::make_shared<run::AfterTime<2>>(m_load_time),
                       .damping = m_damping},
                      {.name = "settling",
                       .ending = std::make_shared<run::AtRest<2>>(
                           run::RestOptions<2>{.tolerance = m_tolerance,
                                               .reference_force = 0.5 * force(),
                                               .longest = 1'000'000,
                                               .check_every = check_every}),
                       .damping = m_damping}};
    problem.observers = {std::make_shared<run::History<2>>(history())};
    return problem;
  }

  run::HistoryTable<2> history() {
    return {.path = path("history.csv"),
            .columns = {"time_s", "load_Pa", "contact_force_N_per_m", "out_of_balance",
                        "kinetic_energy_J_per_m"},
            .row =
                [this](const run::Moment<2>& now) {
                  m_plane->take_forces();
                  double sum = 0.0;
                  for (const double column : m_plane->forces()) sum += column;
                  return std::vector<double>{now.clock.time, load_at(now.clock.time), 2.0 * sum,
                                             run::unbalanced_share(now.simulation, 0.5 * force()),
                                             now.simulation.kinetic_energy()};
                },
            .cadence = run::Cadence<2>(check_every)};
  }

  void evaluate(run::Run<2>& run, io::Summary& summary) override {
    if (!m_plane->forces().empty()) report(run.simulation(), m_plane->forces(), summary);
  }

  /// Width of the surface for which each column of nodes stands, the integral of its function over
  /// x > 0, whatever the basis. Collective.
  static std::vector<double> widths_of_columns(const solver::Simulation<2>& simulation) {
    constexpr int points_per_cell = 12;
    const grid::Grid<2>& grid = simulation.grid();
    const basis::KnotLines &across = grid.nodes(0).lines, &up = grid.nodes(1).lines;
    const double spacing = across.smallest_width() / points_per_cell;
    const double height = 0.5 * (up.begin() + up.end());
    std::vector<Vector<2>> points;
    for (int k = 0; k < points_per_cell * across.cells(); ++k)
      points.push_back({(k + 0.5) * spacing, height});
    constexpr auto scalar = grid::Component::scalar;
    grid::NodalField<2> field(grid, {{scalar}, {0}, {1}});  // the function and its gradient
    field.set_to_zero();
    simulation.step().point_deposit().deposit(points, spacing, grid.owned_cells(), field);
    field.sum_to_owners();
    simulation.walls().fold(grid, field);
    std::vector<double> widths(grid.nodes(0).positions.size(), 0.0);
    grid.for_each_owned_node([&](int I, const auto& node) {
      widths[static_cast<std::size_t>(node[0])] += field.values(0)[I];
    });
    for (double& width : widths) width = petsc::sum(width);
    return widths;
  }

  /// Mean pressure in the particles of the lowest cell above the plane, one value per cell.
  /// Collective.
  std::vector<double> pressure_in_particles(const solver::Simulation<2>& simulation) const {
    const auto count = static_cast<std::size_t>(m_cells);
    std::vector<double> force(count, 0.0), volume(count, 0.0);
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const auto bin = static_cast<std::size_t>(view.position[0][p] / cell());
      if (view.position[1][p] > plane_height() + cell() || bin >= count) continue;
      force[bin] -= view.volume[p] * view.stress[1][p];
      volume[bin] += view.volume[p];
    }
    std::vector<double> pressure;
    for (std::size_t k = 0; k < count; ++k) {
      const double total = petsc::sum(volume[k]);
      pressure.push_back(total > 0.0 ? petsc::sum(force[k]) / total : 0.0);
    }
    return pressure;
  }

  /// The half width follows from the second moment of the pressure, b^2/4 for Hertz's ellipse.
  void report(const solver::Simulation<2>& simulation, const std::vector<double>& forces,
              io::Summary& summary) const {
    const std::vector<double>& x = simulation.grid().nodes(0).positions;
    io::CsvFile profile(m_options.output_dir + "/pressure.csv",
                        {"x_m", "pressure_Pa", "pressure_exact_Pa"});
    const std::vector<double> widths = widths_of_columns(simulation);
    double peak = 0.0, sum = 0.0, moment = 0.0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      if (x[i] < 0.0) continue;
      const double pressure = forces[i] / widths[i];
      profile.row({x[i], pressure, exact_pressure(x[i])});
      peak = std::max(peak, pressure);
      sum += forces[i];
      moment += forces[i] * x[i] * x[i];
    }
    const double half_width = sum > 0.0 ? 2.0 * std::sqrt(moment / sum) : 0.0;
    summary.set("contact_pressure_peak_Pa", peak);
    summary.set("contact_pressure_exact_Pa", exact_peak());
    summary.set("error_contact_pressure", peak / exact_peak() - 1.0);
    summary.set("contact_half_width_m", half_width);
    summary.set("contact_half_width_exact_m", exact_half_width());
    summary.set("error_contact_half_width", half_width / exact_half_width() - 1.0);
    summary.set("contact_force_N_per_m", 2.0 * sum);
    report_particles(simulation, summary);
  }

  void report_particles(const solver::Simulation<2>& simulation, io::Summary& summary) const {
    const std::vector<double> pressure = pressure_in_particles(simulation);
    io::CsvFile profile(m_options.output_dir + "/pressure_particles.csv",
                        {"x_m", "pressure_Pa", "pressure_exact_Pa"});
    for (std::size_t k = 0; k < pressure.size(); ++k) {
      const double middle = (static_cast<double>(k) + 0.5) * cell();
      profile.row({middle, pressure[k], exact_pressure(middle)});
    }
    const double peak = *std::max_element(pressure.begin(), pressure.end());
    summary.set("contact_pressure_peak_particles_Pa", peak);
    summary.set("error_contact_pressure_particles", peak / exact_peak() - 1.0);
  }

  std::shared_ptr<contact::RigidBody<2>> m_body;
  std::shared_ptr<RecordedPlane> m_plane;
  std::size_t m_detection = contact::detection_named("particle");
  double m_gap_cells = 0.6;
  std::int64_t m_cells = 67;
  double m_radius = 8.0;
  double m_offset = 0.6;
  double m_load = 0.625;
  double m_load_time = 12.0;
  double m_damping = 0.5;
  double m_tolerance = 0.01;
  mutable material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Case> make_hertz() {
  return std::make_unique<Hertz>();
}

}  // namespace mpm::cases
