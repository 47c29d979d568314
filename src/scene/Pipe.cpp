#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/analysis/BearingCapacity.hpp"
#include "mpm/analysis/FailureThreshold.hpp"
#include "mpm/contact/ContourReaction.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/GeostaticState.hpp"
#include "mpm/scene/PipeOptions.hpp"
#include "mpm/scene/Ramp.hpp"
#include "mpm/scene/RigidContactOf.hpp"
#include "mpm/scene/Scene.hpp"
#include "mpm/scene/Settling.hpp"

namespace mpm::scene {
namespace {

constexpr double row_spacing = 0.0025;  // u/D between rows of history.csv
constexpr double field_spacing = 0.1;   // u/D between outputs of particles and grid
constexpr double early_field = 0.06;    // u/D, where the wedge under the pipe has formed
constexpr long long check_every = 50;   // steps, of the geostatic residual

/// One line of the resistance curve: means since the line before.
struct Row {
  double u_over_D, N_d, N_d_contour;
};

/// A rigid pipe is pushed down into sand (the paper's section 4): geostatic stage, then loading.
class PipeRun {
 public:
  PipeRun(const PipeOptions& options, io::Summary& summary)
      : m_options(options),
        m_summary(summary),
        m_simulation(options.setup()),
        m_contact(make_contact()),
        m_contour({.inner = 0.15 * options.diameter, .outer = 0.85 * options.diameter}),
        m_loop(options.run, m_simulation),
        m_history(options.run.output_dir + "/history.csv",
                  {"time_s", "displacement_m", "u_over_D", "reaction_N_per_m", "N_d",
                   "reaction_contour_N_per_m", "kinetic_energy_J_per_m", "out_of_balance", "dt_s",
                   "step", "particles_at_limits"}) {
    m_simulation.add_constraint(m_contact);
    m_loop.set_output_numbers([this] { return output_numbers(); });
  }

  void run() {
    prescribe_geostatic(m_simulation, {.unit_weight = m_options.unit_weight(), .K0 = m_options.K0});
    if (rest()) push();
    conclude();
  }

 private:
  std::shared_ptr<contact::RigidContact<2>> make_contact();
  bool rest();
  void push();
  void after_push();
  double particles_at_limits() const;
  void conclude();
  void check_rest();
  void write_row();
  void report_agreement();
  double displacement() const { return -m_options.depth() - m_contact->body().position[1]; }
  double u_over_D() const { return displacement() / m_options.diameter; }
  double whole(double share) const { return m_options.is_half() ? 2.0 * share : share; }
  double kinetic_energy() const { return whole(m_simulation.kinetic_energy()); }
  std::vector<std::pair<std::string, double>> output_numbers() const;

  const PipeOptions& m_options;
  io::Summary& m_summary;
  solver::Simulation<2> m_simulation;
  std::shared_ptr<contact::RigidContact<2>> m_contact;
  contact::ContourReaction<2> m_contour;
  RunLoop<2> m_loop;
  io::CsvFile m_history;
  std::vector<Row> m_rows;
  double m_time_since_row = 0.0;
  double m_next_row = row_spacing;
  double m_next_field = early_field;
  double m_reaction_at_rest = 0.0;
};

std::shared_ptr<contact::RigidContact<2>> PipeRun::make_contact() {
  auto pipe = std::make_shared<contact::RigidBody<2>>(
      std::make_shared<contact::Ball<2>>(m_options.radius()), Vector<2>{0.0, -m_options.depth()});
  auto contact = contact_of(m_simulation, pipe,
                            {.detection = m_options.detection,
                             .normal = m_options.normal,
                             .gap_cells = m_options.gap_cells,
                             .friction = m_options.friction_coefficient(),
                             .reference_density = m_options.density()});
  const double spacing = 0.5 * m_options.cell();
  contact->discretise(m_options.points_in_pipe(spacing), spacing * spacing);
  return contact;
}

/// The soil comes to rest around the pipe, which holds still. False if the run ends before.
bool PipeRun::rest() {
  const auto measure_reaction = [this](double) {
    const double seconds = m_loop.clock().dt * check_every;
    m_reaction_at_rest = whole(petsc::sum(m_contact->body().meter().take_impulse()[1])) / seconds;
  };
  double unbalanced = 1.0;
  const bool goes_on = settle(m_simulation, m_loop,
                              {.name = "geostatic",
                               .damping = m_options.damping,
                               .tolerance = m_options.geostatic_tolerance,
                               .check_every = check_every,
                               .after_check = measure_reaction},
                              unbalanced);
  m_summary.set("geostatic_out_of_balance", unbalanced);
  m_summary.set("geostatic_steps", m_loop.clock().step);
  if (goes_on) check_rest();
  return goes_on;
}

void PipeRun::check_rest() {
  const double N_d = m_reaction_at_rest / m_options.reference_force();
  const double expected = std::numbers::pi / (4.0 * m_options.embedment_ratio);
  m_summary.set("geostatic_N_d", N_d);
  m_summary.set("geostatic_N_d_expected", expected);
  const GeostaticErrors errors =
      measure_geostatic(m_simulation, {.unit_weight = m_options.unit_weight(), .K0 = m_options.K0},
                        [this](const Vector<2>& x) {
                          return m_contact->body().locate(x).distance > 2.0 * m_options.diameter;
                        });
  m_summary.set("geostatic_vertical_stress_error_rms", errors.vertical_rms);
  m_summary.set("geostatic_K0_error_rms", errors.K0_rms);
  const double tolerance = m_options.geostatic_stress_tolerance;
  const bool passed = errors.vertical_rms <= tolerance && errors.K0_rms <= tolerance &&
                      std::abs(N_d - expected) <= 0.3;
  if (!passed)
    throw NumericalFailure(fmt::format(
        "the geostatic state fails its test: vertical stress {:.3g} and K0 {:.3g} off beyond 2 D, "
        "-geostatic_stress_tolerance {}; N_d {:.3g} instead of {:.3g} +- 0.3; a smaller "
        "-geostatic_tolerance, -basis_boundary mirror or a larger tolerance may help",
        errors.vertical_rms, errors.K0_rms, tolerance, N_d, expected));
}

void PipeRun::after_push() {
  const run::Clock& clock = m_loop.clock();
  contact::RigidBody<2>& pipe = m_contact->body();
  pipe.position[1] += pipe.velocity[1] * clock.dt;
  m_contour.sample(m_simulation.particles().view(), pipe, m_simulation.gravity(),
                   clock.momentum_dt);
  m_time_since_row += clock.momentum_dt;
  const bool row_due = m_options.run.history_every > 0
                           ? clock.steps_in_stage % m_options.run.history_every == 0
                           : u_over_D() >= m_next_row;
  if (row_due) write_row();
  if (u_over_D() >= m_next_field) {
    m_loop.write_fields(output_numbers());
    m_next_field = field_spacing * (std::floor(u_over_D() / field_spacing + 1e-6) + 1.0);
  }
}

void PipeRun::write_row() {
  const run::Clock& clock = m_loop.clock();
  const double reaction =
      whole(petsc::sum(m_contact->body().meter().take_impulse()[1])) / m_time_since_row;
  const double contour = whole(m_contour.take_mean()[1]);
  m_time_since_row = 0.0;
  m_next_row = row_spacing * (std::floor(u_over_D() / row_spacing + 1e-6) + 1.0);
  const double N_d = reaction / m_options.reference_force();
  m_rows.push_back({u_over_D(), N_d, contour / m_options.reference_force()});
  m_history.row({clock.time_in_stage, displacement(), u_over_D(), reaction, N_d, contour,
                 kinetic_energy(), m_simulation.out_of_balance(), clock.dt,
                 static_cast<double>(clock.step), particles_at_limits()});
}

/// Particles of all ranks at the sand law's pressure floor or cap of the state parameter.
double PipeRun::particles_at_limits() const {
  const auto& particles = m_simulation.particles();
  const auto view = particles.view();
  std::size_t count = 0;
  for (std::size_t k = 0; k < particles.materials().size(); ++k)
    count +=
        particles.materials()[k]->count_at_limits(particles.batch_of(view, static_cast<int>(k)));
  return petsc::sum(static_cast<double>(count));
}

std::vector<std::pair<std::string, double>> PipeRun::output_numbers() const {
  return {{"displacement_m", displacement()},
          {"pipe_x_m", m_contact->body().position[0]},
          {"pipe_y_m", m_contact->body().position[1]},
          {"N_d",
           m_rows.empty() ? m_reaction_at_rest / m_options.reference_force() : m_rows.back().N_d}};
}

void PipeRun::push() {
  m_loop.begin_anew();
  m_contact->body().meter().take_impulse();
  m_loop.write_fields(output_numbers());
  const Ramp ramp{m_options.velocity, m_options.ramp_distance * m_options.diameter};
  m_loop.run({.name = "loading",
              .share_done = [&] { return u_over_D() / m_options.end_displacement + 1e-9; },
              .before_step =
                  [&](double dt) {
                    const run::Clock& clock = m_loop.clock();
                    m_contact->body().velocity[1] = -ramp.at(clock.time_in_stage + 0.5 * dt);
                  },
              .after_step = [&] { after_push(); },
              .status =
                  [&] {
                    return fmt::format("u/D {:.3f}  N_d {:6.2f}", u_over_D(),
                                       m_rows.empty() ? 0.0 : m_rows.back().N_d);
                  }});
}

/// Compares the two reactions over 0.05 <= u/D <= 0.9, on means over 0.01 in u/D.
void PipeRun::report_agreement() {
  double largest = 0.0, squares = 0.0, compared = 0.0, contact = 0.0, contour = 0.0;
  int rows = 0;
  for (const Row& row : m_rows) {
    if (row.u_over_D < 0.05 || row.u_over_D > 0.9) continue;
    contact += row.N_d;
    contour += row.N_d_contour;
    if (++rows % 4 != 0) continue;
    const double difference = contour / contact - 1.0;
    largest = std::max(largest, std::abs(difference));
    squares += difference * difference;
    compared += 1.0;
    contact = contour = 0.0;
  }
  if (compared == 0.0) return;
  m_summary.set("reaction_difference_rms", std::sqrt(squares / compared));
  m_summary.set("reaction_difference_max", largest);
}

void add(io::Summary& summary, const analysis::SummaryValues& values) {
  for (const auto& [key, value] : values) summary.set(key, value);  // NaN becomes null
}

void PipeRun::conclude() {
  m_loop.write_fields(output_numbers());
  m_loop.summarise(m_summary);
  report_agreement();
  const material::SandParameters& sand = m_options.sand.parameters();
  m_summary.set("symmetry", std::string(m_options.is_half() ? "half" : "full"));
  m_summary.set("unit_weight_N_per_m3", m_options.unit_weight());
  m_summary.set("reference_force_N_per_m", m_options.reference_force());
  m_summary.set("friction_coefficient", m_options.friction_coefficient());
  m_summary.set("relative_density", material::relative_density(sand));
  m_summary.set("cell_over_d50", m_options.cell() / sand.d50);
  if (m_rows.empty()) return;
  m_summary.set("u_over_D_end", m_rows.back().u_over_D);
  m_summary.set("N_d_end", m_rows.back().N_d);
  std::vector<double> u, N_d;
  for (const Row& row : m_rows) {
    u.push_back(row.u_over_D);
    N_d.push_back(row.N_d);
  }
  const analysis::SlopeCurve curve = analysis::slope_curve(u, N_d);
  const std::vector<analysis::FailureThreshold> thresholds{
      analysis::failure_threshold(curve, {.window = 0.75}),
      analysis::failure_threshold(curve, {.window = 0.9})};
  io::write_text_file(m_options.run.output_dir + "/threshold.csv",
                      analysis::threshold_csv(curve, thresholds));
  add(m_summary, analysis::threshold_summary(thresholds[0]));
  add(m_summary, analysis::threshold_summary(thresholds[1], "_to_0.9"));
  m_summary.set("threshold_reason", thresholds[0].reason);
  add(m_summary, analysis::bearing_summary({.diameter = m_options.diameter,
                                            .embedment_ratio = m_options.embedment_ratio,
                                            .unit_weight = m_options.unit_weight(),
                                            .cohesion = sand.cohesion},
                                           thresholds[0].N_df));
}

class Pipe : public Scene {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void run(io::Summary& summary) override { PipeRun(m_options, summary).run(); }

  std::string answer(const io::Summary& summary) const override {
    const std::string N_df = summary.text("N_df");
    if (N_df.empty() || N_df == "null")
      return fmt::format("no failure threshold: {}", summary.text("threshold_reason"));
    return fmt::format("failure threshold N_df = {:.4g} at u_df/D = {:.3g}", summary.number("N_df"),
                       summary.number("u_df_over_D"));
  }

 private:
  PipeOptions m_options;
};

}  // namespace

std::unique_ptr<Scene> make_pipe() {
  return std::make_unique<Pipe>();
}

}  // namespace mpm::scene
