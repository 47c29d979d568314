#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/contact/ContourReaction.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/InitialStress.hpp"
#include "mpm/scene/BiaxialOptions.hpp"
#include "mpm/scene/RigidContactOf.hpp"
#include "mpm/scene/Scene.hpp"
#include "mpm/scene/Settling.hpp"
#include "mpm/scene/WatchedParticle.hpp"

namespace mpm::scene {
namespace {

constexpr double row_spacing = 0.0005;   // axial strain between rows of history.csv
constexpr double residual_range = 0.01;  // axial strain at the end over which stress is averaged
constexpr std::array field_strains{0.013, 0.03, 0.05, 0.075, 0.1, 0.125};

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
  WatchedParticle m_outside, m_inside;
  io::CsvFile m_history;
  std::vector<Row> m_rows;
  double m_time_since_row = 0.0;
  std::size_t m_next_field = 0;
};

std::shared_ptr<contact::RigidContact<2>> make_plate(const BiaxialOptions& options,
                                                     const solver::Simulation<2>& simulation,
                                                     double density) {
  const auto plate = std::make_shared<contact::RigidBody<2>>(
      std::make_shared<contact::HalfSpace<2>>(Vector<2>{0.0, -1.0}),
      Vector<2>{0.0, options.height});
  return contact_of(
      simulation, plate,
      {.gap_cells = options.gap_cells, .friction = options.friction, .reference_density = density});
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
  m_simulation.add_constraint(m_plate);
  m_simulation.boundary().add(options.sides());
  m_loop.set_output_numbers([this] { return output_numbers(); });
}

void BiaxialRun::run() {
  run::prescribe_pressure(m_simulation, m_options.confining_pressure);
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
  m_summary.set("consolidation_steps", m_loop.clock().step);
  return goes_on;
}

void BiaxialRun::compress() {
  m_loop.begin_anew();
  m_plate->body().meter().take_impulse();
  m_loop.write_fields(output_numbers());
  m_loop.run({.name = "compression",
              .share_done = [&] { return axial_strain() / m_options.strain_end + 1e-9; },
              .before_step =
                  [&](double dt) {
                    const run::Clock& clock = m_loop.clock();
                    m_plate->body().velocity[1] =
                        -m_options.ramp().at(clock.time_in_stage + 0.5 * dt);
                  },
              .after_step = [&] { after_step(); },
              .status =
                  [&] {
                    return fmt::format("strain {:.2f} %  stress {:.0f} kPa", 100.0 * axial_strain(),
                                       m_rows.empty() ? 0.0 : m_rows.back().stress / 1e3);
                  }});
}

void BiaxialRun::after_step() {
  const run::Clock& clock = m_loop.clock();
  contact::RigidBody<2>& plate = m_plate->body();
  plate.position[1] += plate.velocity[1] * clock.dt;
  m_contour.sample(m_simulation.particles().view(), plate, m_simulation.gravity(),
                   clock.momentum_dt);
  m_contour.sample_surface(m_simulation.boundary().view(), plate, clock.momentum_dt);
  m_time_since_row += clock.momentum_dt;
  const bool row_due =
      m_options.run.history_every > 0
          ? clock.steps_in_stage % m_options.run.history_every == 0
          : axial_strain() >= row_spacing * (static_cast<double>(m_rows.size()) + 1);
  if (row_due) write_row();
  if (m_next_field < field_strains.size() && axial_strain() >= field_strains[m_next_field]) {
    m_loop.write_fields(output_numbers());
    ++m_next_field;
  }
}

void BiaxialRun::write_row() {
  const run::Clock& clock = m_loop.clock();
  const double impulse = petsc::sum(m_plate->body().meter().take_impulse()[1]);
  const double stress = impulse / m_time_since_row / m_options.width;
  const double contour = m_contour.take_mean()[1] / m_options.width;
  m_time_since_row = 0.0;
  m_rows.push_back({axial_strain(), stress, contour});
  std::vector<double> row{clock.time_in_stage, axial_strain() * m_options.height, axial_strain(),
                          stress, contour};
  for (const WatchedParticle* point : {&m_outside, &m_inside}) {
    const std::vector<double> values = point->observe(m_simulation.particles());
    row.insert(row.end(), values.begin(), values.end());
  }
  row.insert(row.end(), {m_simulation.kinetic_energy(), clock.dt, static_cast<double>(clock.step)});
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
  m_summary.set("stress_difference_rms", std::sqrt(squares / static_cast<double>(m_rows.size())));
  m_summary.set("stress_difference_max", largest);
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
