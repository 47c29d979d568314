#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mpm/analysis/BearingCapacity.hpp"
#include "mpm/analysis/FailureThreshold.hpp"
#include "mpm/cases/GeostaticState.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/PipeEvidence.hpp"
#include "mpm/cases/ReactionAgreement.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/BodyReaction.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"
#include "mpm/run/Inertia.hpp"

namespace mpm::cases {
namespace {

constexpr double row_spacing = 0.0025;  // u/D between rows of history.csv
constexpr double field_spacing = 0.1;   // u/D between outputs of particles and grid
constexpr double early_field = 0.06;    // u/D, where the wedge under the pipe has formed
constexpr double band_begin = 0.15;     // D, distance of the contour from the pipe
constexpr double band_end = 0.85;       // D
constexpr double last_compared = 0.9;   // u/D, of the two reactions
constexpr std::size_t u_over_D_column = 2, N_d_column = 4, N_d_contour_column = 8,
                      inertia_column = 10, evidence_column = 11,
                      in_pipe_column = evidence_column + 1;

using Now = run::Moment<2>;

/// What is known when the soil has come to rest around the pipe.
class AtRestAnswers : public run::Observer<2> {
 public:
  double N_d = 0.0;  ///< over the last interval between two checks
  double unbalanced = 1.0;
  long long steps = 0;
  GeostaticErrors stress{0.0, 0.0};
  bool has_rested = false;

  void persist(Archive& archive) override {
    archive("N_d", N_d);
    archive("unbalanced", unbalanced);
    archive("steps", steps);
    archive("vertical_rms", stress.vertical_rms);
    archive("K0_rms", stress.K0_rms);
    archive("has_rested", has_rested);
  }
};

/// A rigid pipe is pushed down into sand (the paper's section 4): geostatic stage, then loading.
class Pipe : public GridCase<2> {
 public:
  void declare(options::OptionSet& options) override { m_pipe.declare(options); }

  std::string answer(const io::Summary& summary) const override {
    const std::string N_df = summary.text("N_df");
    if (N_df.empty() || N_df == "null")
      return fmt::format("no failure threshold: {}", summary.text("threshold_reason"));
    return fmt::format("failure threshold N_df = {:.4g} at u_df/D = {:.3g}", summary.number("N_df"),
                       summary.number("u_df_over_D"));
  }

 private:
  const run::RunOptions& run_options() const override { return m_pipe.run; }
  run::Problem<2> problem() override;
  void evaluate(run::Run<2>& run, io::Summary& summary) override;

  void make_body();
  std::shared_ptr<grid::Constraint<2>> make_contact(const solver::Simulation<2>& simulation) const;
  run::Stage<2> rest();
  run::Stage<2> push() const;
  void check_rest(const Now& now);
  run::HistoryTable<2> history();
  std::vector<double> row(const Now& now);
  run::Numbers field_numbers() const;
  void report_rest(io::Summary& summary) const;
  void report_model(io::Summary& summary) const;
  void report_agreement(io::Summary& summary) const;
  double inertia_at(double displacement_over_D) const;
  void report_threshold(io::Summary& summary) const;

  double displacement() const { return -m_pipe.depth() - m_body->position[1]; }
  double u_over_D() const { return displacement() / m_pipe.diameter; }
  double whole(double share) const { return m_pipe.is_half() ? 2.0 * share : share; }
  GeostaticStress geostatic() const { return {m_pipe.unit_weight(), m_pipe.K0}; }

  PipeOptions m_pipe;
  std::shared_ptr<contact::RigidBody<2>> m_body;
  std::shared_ptr<run::Inertia<2>> m_inertia;
  std::shared_ptr<run::BodyReaction<2>> m_reaction;
  std::shared_ptr<run::AtRest<2>> m_ending;
  std::shared_ptr<run::History<2>> m_history;
  std::shared_ptr<AtRestAnswers> m_rest;
};

run::Problem<2> Pipe::problem() {
  make_body();
  m_rest = std::make_shared<AtRestAnswers>();
  m_history = std::make_shared<run::History<2>>(history());
  run::Problem<2> problem{.setup = m_pipe.setup()};
  problem.initial_stress = vertical_and_lateral(geostatic());
  problem.initial_stress_remedy = fmt::format(
      "-geostatic_K0 {} is more than the soil can bear; take a value nearer to 1 or a stronger "
      "soil",
      m_pipe.K0);
  problem.bodies = {m_body};
  problem.constraints = {[this](const auto& simulation) { return make_contact(simulation); }};
  problem.stages = {rest(), push()};
  problem.observers = {m_rest, m_inertia, m_reaction, m_history};
  problem.field_cadence = run::Cadence<2>(
      field_spacing, [this](const Now&) { return u_over_D(); }, early_field);
  problem.writes_fields_at_start = true;
  problem.field_numbers = [this](const Now&) { return field_numbers(); };
  return problem;
}

void Pipe::make_body() {
  const auto paced = m_pipe.paced_motion();
  m_body = std::make_shared<contact::RigidBody<2>>(
      std::make_shared<geometry::Ball<2>>(m_pipe.radius()), Vector<2>{0.0, -m_pipe.depth()},
      paced ? paced : m_pipe.ramped_motion());
  m_inertia = std::make_shared<run::Inertia<2>>(m_body, paced, m_pipe.inertia());
  m_reaction = std::make_shared<run::BodyReaction<2>>(
      m_body, contact::ContourBand{.inner = band_begin * m_pipe.diameter,
                                   .outer = band_end * m_pipe.diameter});
}

std::shared_ptr<grid::Constraint<2>> Pipe::make_contact(
    const solver::Simulation<2>& simulation) const {
  const double spacing = 0.5 * m_pipe.cell();
  return contact_of(simulation, m_body,
                    {.detection = m_pipe.detection,
                     .normal = m_pipe.normal,
                     .gap_cells = m_pipe.gap_cells,
                     .friction = m_pipe.friction_coefficient(),
                     .reference_density = m_pipe.density()},
                    {m_pipe.points_in_pipe(spacing), spacing * spacing});
}

/// The soil comes to rest around the pipe, which holds still.
run::Stage<2> Pipe::rest() {
  m_ending = std::make_shared<run::AtRest<2>>(run::RestOptions<2>{
      .tolerance = m_pipe.geostatic_tolerance, .at_check = [this](const Now&) {
        m_rest->N_d = whole(m_body->meter().take_mean().force[1]) / m_pipe.reference_force();
      }});
  return {.name = "geostatic",
          .ending = m_ending,
          .is_main = false,
          .damping = m_pipe.damping,
          .holds_bodies = true,
          .at_end = [this](const Now& now) { check_rest(now); }};
}

void Pipe::check_rest(const Now& now) {
  m_rest->has_rested = true;
  m_rest->unbalanced = m_ending->unbalanced();
  m_rest->steps = now.clock.step;
  m_rest->stress = measure_geostatic(now.simulation, geostatic(), [this](const Vector<2>& x) {
    return m_body->locate(x).distance > 2.0 * m_pipe.diameter;
  });
  const double expected = std::numbers::pi / (4.0 * m_pipe.embedment_ratio);
  const double tolerance = m_pipe.geostatic_stress_tolerance;
  const double reaction_error = m_rest->N_d / expected - 1.0;
  if (m_rest->stress.vertical_rms > tolerance || m_rest->stress.K0_rms > tolerance)
    throw NumericalFailure(fmt::format(
        "the geostatic state fails its test: vertical stress {:.3g} and K0 {:.3g} off beyond 2 D, "
        "-geostatic_stress_tolerance {}; a smaller -geostatic_tolerance, -basis_boundary mirror or "
        "a larger tolerance may help",
        m_rest->stress.vertical_rms, m_rest->stress.K0_rms, tolerance));
  if (!(std::abs(reaction_error) <= m_pipe.geostatic_reaction_tolerance))
    throw NumericalFailure(fmt::format(
        "the geostatic state fails its test: the pipe at rest carries N_d {:.3g} instead of "
        "{:.3g}, "
        "{:+.0f} %, -geostatic_reaction_tolerance {}; -contact_detection spring, more "
        "-pipe_cells_per_diameter, a smaller -geostatic_tolerance or a larger tolerance may help",
        m_rest->N_d, expected, 100.0 * reaction_error, m_pipe.geostatic_reaction_tolerance));
}

run::Stage<2> Pipe::push() const {
  return {.name = "loading",
          .ending = std::make_shared<run::When<2>>(
              [this](const Now&) { return u_over_D() / m_pipe.end_displacement + 1e-9; }),
          .begins_anew = true};
}

run::HistoryTable<2> Pipe::history() {
  std::vector<std::string> columns{"time_s",
                                   "displacement_m",
                                   "u_over_D",
                                   "reaction_N_per_m",
                                   "N_d",
                                   "reaction_contour_N_per_m",
                                   "kinetic_energy_J_per_m",
                                   "out_of_balance",
                                   "N_d_contour",
                                   "velocity_m_per_s",
                                   "inertia"};
  std::ranges::copy(PipeEvidence::columns(), std::back_inserter(columns));
  return {.path = path("history.csv"),
          .columns = std::move(columns),
          .row = [this](const Now& now) { return row(now); },
          .cadence = run::Cadence<2>(row_spacing, [this](const Now&) { return u_over_D(); })
                         .or_every(m_pipe.run.history_every),
          .status =
              [this](const run::History<2>& rows) {
                return fmt::format("u/D {:.3f}  N_d {:6.2f}", u_over_D(), rows.last(N_d_column));
              },
          .columns_before_clock = N_d_contour_column,
          .has_ledger = true};
}

/// Means since the row before.
std::vector<double> Pipe::row(const Now& now) {
  const double reaction = whole(m_reaction->take_by_impulse().force[1]);
  const double contour = whole(m_reaction->take_by_contour().force[1]);
  std::vector<double> row{now.clock.time_in_stage,
                          displacement(),
                          u_over_D(),
                          reaction,
                          reaction / m_pipe.reference_force(),
                          contour,
                          whole(now.simulation.kinetic_energy()),
                          now.simulation.out_of_balance(),
                          contour / m_pipe.reference_force(),
                          -m_body->velocity[1],
                          m_inertia->share()};
  std::ranges::copy(PipeEvidence(m_pipe).row(now, *m_body, reaction), std::back_inserter(row));
  return row;
}

run::Numbers Pipe::field_numbers() const {
  return {{"displacement_m", displacement()},
          {"pipe_x_m", m_body->position[0]},
          {"pipe_y_m", m_body->position[1]},
          {"N_d", m_history->last(N_d_column, m_rest->N_d)}};
}

void Pipe::evaluate(run::Run<2>&, io::Summary& summary) {
  report_rest(summary);
  report_model(summary);
  report_agreement(summary);
  if (!m_history->rows().empty())
    report_threshold(summary);
  else
    summary.set("threshold_reason", std::string("the run ended before the first row of loading"));
}

void Pipe::report_rest(io::Summary& summary) const {
  summary.set("geostatic_out_of_balance", m_ending->unbalanced());
  if (!m_rest->has_rested) return;
  summary.set("geostatic_steps", m_rest->steps);
  summary.set("geostatic_N_d", m_rest->N_d);
  summary.set("geostatic_N_d_expected", std::numbers::pi / (4.0 * m_pipe.embedment_ratio));
  summary.set("geostatic_vertical_stress_error_rms", m_rest->stress.vertical_rms);
  summary.set("geostatic_K0_error_rms", m_rest->stress.K0_rms);
}

void Pipe::report_agreement(io::Summary& summary) const {
  const ReactionAgreement reactions = compare_reactions(
      *m_history, {u_over_D_column, N_d_column, N_d_contour_column}, last_compared);
  if (std::isnan(reactions.rms)) return;
  summary.set("reaction_difference_rms", reactions.rms);
  summary.set("reaction_difference_max", reactions.largest);
}

void Pipe::report_model(io::Summary& summary) const {
  const material::SandParameters& sand = m_pipe.sand.parameters();
  summary.set("symmetry", std::string(m_pipe.is_half() ? "half" : "full"));
  summary.set("unit_weight_N_per_m3", m_pipe.unit_weight());
  summary.set("reference_force_N_per_m", m_pipe.reference_force());
  summary.set("friction_coefficient", m_pipe.friction_coefficient());
  summary.set("relative_density", material::relative_density(sand));
  summary.set("cell_over_d50", m_pipe.cell() / sand.d50);
}

void add(io::Summary& summary, const analysis::SummaryValues& values) {
  for (const auto& [key, value] : values) summary.set(key, value);  // NaN becomes null
}

/// In the last row before a displacement; not a number where there is none.
double Pipe::inertia_at(double displacement_over_D) const {
  double inertia = std::numeric_limits<double>::quiet_NaN();
  for (const auto& row : m_history->rows())
    if (row[u_over_D_column] <= displacement_over_D) inertia = row[inertia_column];
  return inertia;
}

void Pipe::report_threshold(io::Summary& summary) const {
  summary.set("u_over_D_end", m_history->last(u_over_D_column));
  summary.set("N_d_end", m_history->last(N_d_column));
  const analysis::SlopeCurve curve =
      analysis::slope_curve(m_history->column(u_over_D_column), m_history->column(N_d_column));
  const double tooth_period = m_pipe.cell() / m_pipe.diameter;  // of contact passing grid lines
  std::vector<analysis::FailureThreshold> thresholds{
      analysis::failure_threshold(curve, {.window = 0.75, .tooth_period = tooth_period}),
      analysis::failure_threshold(curve, {.window = 0.9, .tooth_period = tooth_period})};
  summary.set("particles_in_pipe_most", std::ranges::max(m_history->column(in_pipe_column)));
  hold_evidence(m_pipe, *m_history,
                {u_over_D_column, N_d_column, N_d_contour_column, inertia_column, evidence_column},
                thresholds[0].u_df_over_D, summary);
  if (summary.is_withheld())
    for (analysis::FailureThreshold& threshold : thresholds)
      threshold = analysis::no_threshold(threshold.window, "withheld: see answer_withheld");
  io::write_text_file(path("threshold.csv"), analysis::threshold_csv(curve, thresholds));
  add(summary, analysis::threshold_summary(thresholds[0]));
  add(summary, analysis::threshold_summary(thresholds[1], "_to_0.9"));
  summary.set("threshold_reason", thresholds[0].reason);
  summary.set("inertia_at_threshold", inertia_at(thresholds[0].u_df_over_D));
  add(summary, analysis::bearing_summary({.diameter = m_pipe.diameter,
                                          .embedment_ratio = m_pipe.embedment_ratio,
                                          .unit_weight = m_pipe.unit_weight(),
                                          .cohesion = m_pipe.sand.parameters().cohesion},
                                         thresholds[0].N_df));
}

}  // namespace

std::unique_ptr<Case> make_pipe() {
  return std::make_unique<Pipe>();
}

}  // namespace mpm::cases
