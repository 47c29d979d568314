#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mpm/contact/ContourReaction.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/InitialStress.hpp"
#include "mpm/scene/Scene.hpp"
#include "mpm/scene/Settling.hpp"

namespace mpm::scene {
namespace {

constexpr double row_spacing = 0.0005;   // axial strain between rows of history.csv
constexpr double residual_range = 0.01;  // axial strain at the end over which stress is averaged
constexpr std::array field_strains{0.013, 0.03, 0.05, 0.075, 0.1, 0.125};

/// Options of the biaxial scene. The specimen stands on y = 0, its axis is x = 0.
struct BiaxialOptions {
  RunOptions run;
  material::SandFactory sand;

  double width = 1.0;   ///< m
  double height = 2.0;  ///< m
  double cell_size = 0.1;
  double confining_pressure = 400e3;
  double velocity = 0.03;      ///< m/s
  double ramp_strain = 0.001;  ///< axial strain in which the plate gets to its velocity
  double strain_end = 0.15;
  double friction = 100.0;
  double gap_cells = 0.6;
  double damping = 0.7;
  double tolerance = 1e-3;
  std::vector<double> points{0.0, 1.5, 0.0, 1.2};  ///< x and y of two particles to be watched, m

  BiaxialOptions();
  void declare(options::OptionSet& options);
  solver::SimulationSetup<2> setup() const;
  std::vector<particles::SurfacePiece<2>> sides() const;
  double velocity_at(double time) const;

 private:
  void declare_specimen(options::OptionSet& options);
  void declare_loading(options::OptionSet& options);
  int cells_over(const char* name, double length) const;
};

BiaxialOptions::BiaxialOptions() {
  run.output_dir = "out/biaxial";
  run.flip_time =
      0.01;  // else particles at the free sides end up with 10 m/s that the grid ignores
  sand.parameters().cohesion = 0.0;
  sand.parameters().void_ratio = 0.581;
}

void BiaxialOptions::declare(options::OptionSet& options) {
  run.declare(options);
  options.section("Biaxial");
  declare_specimen(options);
  declare_loading(options);
  sand.declare(options);
}

void BiaxialOptions::declare_specimen(options::OptionSet& options) {
  options.real("biaxial_width", width, options::positive(),
               {"m", "of the specimen, whole cells", "chosen: the paper gives no size"});
  options.real("biaxial_height", height, options::positive(),
               {"m", "of the specimen, whole cells", "chosen: the paper gives no size"});
  options.real("cell_size", cell_size, options::positive(),
               {"m", "side of the square cells", "paper, section 3.2"});
  options.real("confining_pressure", confining_pressure, options::positive(),
               {"Pa", "on the sides, and everywhere at the start", "paper, section 3.2"});
  options.real_list("biaxial_points", points, {},
                    {"m", "x,y,x,y of two places; the particles nearest to them are watched",
                     "chosen: outside and inside the shear bands"});
}

void BiaxialOptions::declare_loading(options::OptionSet& options) {
  options.real("biaxial_velocity", velocity, options::positive(),
               {"m/s", "of the plate, downward", "paper, section 3.2"});
  options.real("biaxial_ramp_strain", ramp_strain, options::between(0.0, 1.0),
               {"1", "axial strain over which the velocity rises as (1 - cos)/2", "chosen"});
  options.real(
      "strain_end", strain_end, {.minimum = 0.0, .maximum = 0.5, .open_minimum = true},
      {"1", "last axial strain, displacement of the plate over height", "paper, section 3.2"});
  options.real("contact_friction", friction, options::not_negative(),
               {"1", "Coulomb coefficient between sand and plate; 100 is as good as rough",
                "paper, section 3.2"});
  options.real("contact_gap_cells", gap_cells, {.minimum = 0.0, .maximum = 2.0},
               {"cells", "largest distance of a touching node from the plate", "docs/model.md"});
  options.real(
      "damping", damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
      {"1", "local damping of the consolidation only, f -= damping |f| sign(v)", "docs/model.md"});
  options.real("rest_tolerance", tolerance, {.minimum = 1e-12, .maximum = 0.1},
               {"1",
                "consolidation ends when sum |f| falls below this share of pressure times "
                "height",
                "chosen"});
}

int BiaxialOptions::cells_over(const char* name, double length) const {
  const double cells = length / cell_size;
  if (std::abs(cells - std::round(cells)) > 1e-6 * cells || cells < 2.0)
    throw BadInput(
        fmt::format("-{} {} m is {:.6g} cells of -cell_size {} m: whole numbers from 2 "
                    "on are allowed",
                    name, length, cells, cell_size));
  return static_cast<int>(std::round(cells));
}

solver::SimulationSetup<2> BiaxialOptions::setup() const {
  const int across = cells_over("biaxial_width", width);
  const int up = cells_over("biaxial_height", height);
  const int margin = across / 2 + 1;  // room for bulging
  const int above = 3;                // nodes of the plate
  const double half = 0.5 * width;
  using grid::Wall;
  solver::SimulationSetup<2> setup{
      .lines = {basis::KnotLines::uniform(-half - margin * cell_size, half + margin * cell_size,
                                          across + 2 * margin),
                basis::KnotLines::uniform(0.0, (up + above) * cell_size, up + above)}};
  run.apply_to(setup);
  setup.walls = {{{Wall::free, Wall::free}, {Wall::fixed, Wall::free}}};
  setup.materials = {sand.create()};
  setup.filling = {
      [half, top = height](const Vector<2>& x) {
        return std::abs(x[0]) < half && x[1] < top ? std::optional(0) : std::nullopt;
      },
      [n = static_cast<int>(run.particles_per_cell_direction)](const auto&) { return n; }};
  return setup;
}

/// A piece of surface beside each particle of the two sides.
std::vector<particles::SurfacePiece<2>> BiaxialOptions::sides() const {
  const double spacing = cell_size / static_cast<double>(run.particles_per_cell_direction);
  const auto rows = static_cast<int>(std::round(height / spacing));
  std::vector<particles::SurfacePiece<2>> pieces;
  for (const double side : {-1.0, 1.0})
    for (int j = 0; j < rows; ++j)
      pieces.push_back({.anchor = {side * 0.5 * (width - spacing), (j + 0.5) * spacing},
                        .offset = {side * 0.5 * spacing, 0.0},
                        .area = {side * spacing, 0.0},
                        .pressure = confining_pressure});
  return pieces;
}

double BiaxialOptions::velocity_at(double time) const {
  const double ramp = 2.0 * ramp_strain * height / velocity;
  if (time >= ramp) return velocity;
  return 0.5 * velocity * (1.0 - std::cos(std::numbers::pi * time / ramp));
}

/// One particle that is followed through the run, wherever it goes.
class Watched {
 public:
  /// The particle nearest to x. Collective.
  Watched(const particles::Particles<2>& particles, const Vector<2>& x);

  /// q, p, volumetric strain, void ratio, eps_q; compression positive. Collective.
  std::vector<double> observe(const particles::Particles<2>& particles) const;

 private:
  std::int64_t m_id = 0;
  double m_initial_volume = 0.0;
};

Watched::Watched(const particles::Particles<2>& particles, const Vector<2>& x) {
  const auto view = particles.view();
  double nearest = std::numeric_limits<double>::max();
  std::int64_t id = -1;
  double volume = 0.0;
  for (int p = 0; p < view.count; ++p) {
    const double distance = std::hypot(view.position[0][p] - x[0], view.position[1][p] - x[1]);
    if (distance > nearest || (distance == nearest && view.id[p] > id)) continue;
    nearest = distance;
    id = view.id[p];
    volume = view.volume[p];
  }
  const bool mine = nearest == petsc::minimum(nearest);
  // Of equally near ones the smallest id, on whatever rank it is.
  const double smallest = petsc::minimum(mine ? static_cast<double>(id) : 1e300);
  m_id = static_cast<std::int64_t>(smallest);
  m_initial_volume = petsc::maximum(mine && id == m_id ? volume : 0.0);
}

std::vector<double> Watched::observe(const particles::Particles<2>& particles) const {
  std::vector<double> values(5, 0.0);
  {
    const auto view = particles.view();
    const auto p = std::find(view.id, view.id + view.count, m_id) - view.id;
    if (p < view.count) {
      SymmetricTensor stress;
      for (int k = 0; k < tensor_components<2>; ++k) stress[k] = view.stress[k][p];
      values = {std::sqrt(1.5) * norm(deviator(stress)), -trace(stress) / 3.0,
                -std::log(view.volume[p] / m_initial_volume), view.state[0][p], view.state[1][p]};
    }
  }
  for (double& value : values) value = petsc::sum(value);
  return values;
}

/// Plane-strain compression under a rough plate (the paper's section 3.2): consolidation under the
/// confining pressure, then the plate comes down.
class BiaxialRun {
 public:
  BiaxialRun(const BiaxialOptions& options, io::Summary& summary);
  void run();

 private:
  struct Row {
    double strain, stress, stress_contour;
  };

  bool consolidate();
  void compress();
  void after_step();
  void write_row();
  void conclude();
  double axial_strain() const { return 1.0 - m_plate->body().position[1] / m_options.height; }
  std::vector<std::pair<std::string, double>> output_numbers() const;

  const BiaxialOptions& m_options;
  io::Summary& m_summary;
  solver::Simulation<2> m_simulation;
  std::shared_ptr<contact::RigidContact<2>> m_plate;
  contact::ContourReaction<2> m_contour;
  RunLoop<2> m_loop;
  Watched m_outside, m_inside;
  io::CsvFile m_history;
  std::vector<Row> m_rows;
  double m_time_since_row = 0.0;
  std::size_t m_next_field = 0;
};

std::shared_ptr<contact::RigidContact<2>> make_plate(const BiaxialOptions& options,
                                                     const solver::Simulation<2>& simulation,
                                                     double density) {
  const contact::RigidBody<2> plate{std::make_shared<contact::HalfSpace<2>>(Vector<2>{0.0, -1.0}),
                                    {0.0, options.height}};
  return std::make_shared<contact::RigidContact<2>>(
      simulation.grid(), simulation.walls(), simulation.step().point_deposit(), plate,
      contact::ContactOptions{.gap_cells = options.gap_cells,
                              .friction = options.friction,
                              .reference_density = density});
}

BiaxialRun::BiaxialRun(const BiaxialOptions& options, io::Summary& summary)
    : m_options(options),
      m_summary(summary),
      m_simulation(options.setup()),
      m_plate(make_plate(options, m_simulation,
                         m_simulation.particles().materials()[0]->initial_density())),
      m_contour({.inner = 0.1 * options.height, .outer = 0.4 * options.height}),
      m_loop(options.run, m_simulation),
      m_outside(m_simulation.particles(), {options.points[0], options.points[1]}),
      m_inside(m_simulation.particles(), {options.points[2], options.points[3]}),
      m_history(options.run.output_dir + "/history.csv",
                {"time_s", "displacement_m", "axial_strain", "vertical_stress_Pa",
                 "vertical_stress_contour_Pa", "point1_q_Pa", "point1_p_Pa",
                 "point1_volumetric_strain", "point1_void_ratio", "point1_eps_q", "point2_q_Pa",
                 "point2_p_Pa", "point2_volumetric_strain", "point2_void_ratio", "point2_eps_q",
                 "kinetic_energy_J_per_m", "dt_s", "step"}) {
  m_simulation.add_condition(m_plate);
  m_simulation.boundary().add(options.sides());
  m_loop.set_output_numbers([this] { return output_numbers(); });
}

void BiaxialRun::run() {
  const double p0 = m_options.confining_pressure;
  prescribe_stress<2>(m_simulation, [p0](const auto&) {
    return SymmetricTensor{{-p0, -p0, -p0, 0.0, 0.0, 0.0}};
  });
  if (consolidate()) compress();
  conclude();
}

/// The stress is there from the start; what is left over at the specimen's edges dies out.
bool BiaxialRun::consolidate() {
  double unbalanced = 1.0;
  const bool goes_on = settle(m_simulation, m_loop,
                              {.name = "consolidation",
                               .damping = m_options.damping,
                               .tolerance = m_options.tolerance,
                               .reference_force = m_options.confining_pressure * m_options.height},
                              unbalanced);
  m_summary.set("consolidation_out_of_balance", unbalanced);
  m_summary.set("consolidation_steps", m_simulation.state().step);
  return goes_on;
}

void BiaxialRun::compress() {
  m_simulation.start_from_rest();
  m_simulation.state().time = 0.0;
  m_plate->take_impulse();
  m_loop.write_fields(output_numbers());
  m_loop.run({.name = "compression",
              .share_done = [&] { return axial_strain() / m_options.strain_end + 1e-9; },
              .before_step =
                  [&] {
                    const solver::RunState& state = m_simulation.state();
                    m_plate->body().velocity[1] =
                        -m_options.velocity_at(state.time_in_stage + 0.5 * state.dt);
                  },
              .after_step = [&] { after_step(); },
              .status =
                  [&] {
                    return fmt::format("strain {:.2f} %  stress {:.0f} kPa", 100.0 * axial_strain(),
                                       m_rows.empty() ? 0.0 : m_rows.back().stress / 1e3);
                  }});
}

void BiaxialRun::after_step() {
  const solver::RunState& state = m_simulation.state();
  contact::RigidBody<2>& plate = m_plate->body();
  plate.position[1] += plate.velocity[1] * state.dt_old;
  m_contour.sample(m_simulation.particles().view(), plate, m_simulation.gravity(),
                   state.last_momentum_dt);
  m_contour.sample_surface(m_simulation.boundary().view(), plate, state.last_momentum_dt);
  m_time_since_row += state.last_momentum_dt;
  const bool row_due =
      m_options.run.history_every > 0
          ? state.steps_in_stage % m_options.run.history_every == 0
          : axial_strain() >= row_spacing * (static_cast<double>(m_rows.size()) + 1);
  if (row_due) write_row();
  if (m_next_field < field_strains.size() && axial_strain() >= field_strains[m_next_field]) {
    m_loop.write_fields(output_numbers());
    ++m_next_field;
  }
}

void BiaxialRun::write_row() {
  const solver::RunState& state = m_simulation.state();
  const double impulse = petsc::sum(m_plate->take_impulse()[1]);
  const double stress = impulse / m_time_since_row / m_options.width;
  const double contour = m_contour.take_mean()[1] / m_options.width;
  m_time_since_row = 0.0;
  m_rows.push_back({axial_strain(), stress, contour});
  std::vector<double> row{state.time_in_stage, axial_strain() * m_options.height, axial_strain(),
                          stress, contour};
  for (const Watched* point : {&m_outside, &m_inside}) {
    const std::vector<double> values = point->observe(m_simulation.particles());
    row.insert(row.end(), values.begin(), values.end());
  }
  row.insert(row.end(),
             {m_simulation.kinetic_energy(), state.dt_old, static_cast<double>(state.step)});
  m_history.row(row);
}

std::vector<std::pair<std::string, double>> BiaxialRun::output_numbers() const {
  return {{"axial_strain", axial_strain()},
          {"plate_y_m", m_plate->body().position[1]},
          {"vertical_stress_Pa", m_rows.empty() ? 0.0 : m_rows.back().stress}};
}

void BiaxialRun::conclude() {
  m_loop.write_fields(output_numbers());
  m_loop.summarise(m_summary);
  if (m_rows.empty()) return;
  const auto peak = std::max_element(
      m_rows.begin(), m_rows.end(), [](const Row& a, const Row& b) { return a.stress < b.stress; });
  double residual = 0.0, count = 0.0, squares = 0.0, largest = 0.0;
  for (const Row& row : m_rows) {
    const double difference = row.stress_contour / row.stress - 1.0;
    squares += difference * difference;
    largest = std::max(largest, std::abs(difference));
    if (row.strain < m_rows.back().strain - residual_range) continue;
    residual += row.stress;
    count += 1.0;
  }
  m_summary.set("stress_peak_Pa", peak->stress);
  m_summary.set("strain_at_peak", peak->strain);
  m_summary.set("stress_residual_Pa", residual / count);
  m_summary.set("axial_strain_end", m_rows.back().strain);
  m_summary.set("reaction_difference_rms", std::sqrt(squares / static_cast<double>(m_rows.size())));
  m_summary.set("reaction_difference_max", largest);
}

class Biaxial : public Scene {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void run(io::Summary& summary) override {
    if (m_options.points.size() != 4)
      throw BadInput(fmt::format("-biaxial_points: {} numbers; four are needed, x,y,x,y in m",
                                 m_options.points.size()));
    BiaxialRun(m_options, summary).run();
  }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("stress_peak_Pa").empty()) return "ended before the first row of the history";
    return fmt::format("peak {:.4g} kPa at {:.3g} % axial strain, residual {:.4g} kPa",
                       summary.number("stress_peak_Pa") / 1e3,
                       100.0 * summary.number("strain_at_peak"),
                       summary.number("stress_residual_Pa") / 1e3);
  }

 private:
  BiaxialOptions m_options;
};

}  // namespace

std::unique_ptr<Scene> make_biaxial() {
  return std::make_unique<Biaxial>();
}

}  // namespace mpm::scene
