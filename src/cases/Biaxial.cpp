#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/cases/BiaxialOptions.hpp"
#include "mpm/cases/Evidence.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/run/BodyReaction.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"
#include "mpm/run/WatchedParticle.hpp"

namespace mpm::cases {
namespace {

constexpr double row_spacing = 0.0005;   // axial strain between rows of history.csv
constexpr double residual_range = 0.01;  // axial strain at the end over which stress is averaged
const std::vector<double> field_strains{0.013, 0.03, 0.05, 0.075, 0.1, 0.125};
constexpr std::size_t strain_column = 2, stress_column = 3, contour_column = 4;

using Now = run::Moment<2>;

/// How long the specimen took to come to rest.
class Consolidation : public run::Observer<2> {
 public:
  long long steps = 0;
  void persist(Archive& archive) override { archive("steps", steps); }
};

/// Plane-strain compression under a rough plate (the paper's section 3.2): consolidation under the
/// confining pressure, then the plate comes down.
class Biaxial : public GridCase<2> {
 public:
  void declare(options::OptionSet& options) override { m_test.declare(options); }

  std::string answer(const io::Summary& summary) const override {
    if (summary.text("stress_peak_Pa").empty()) return "ended before the first row of the history";
    return fmt::format("peak {:.4g} kPa at {:.3g} % axial strain, residual {:.4g} kPa",
                       summary.number("stress_peak_Pa") / 1e3,
                       100.0 * summary.number("strain_at_peak"),
                       summary.number("stress_residual_Pa") / 1e3);
  }

 private:
  const run::RunOptions& run_options() const override { return m_test.run; }
  run::Problem<2> problem() override;
  void evaluate(run::Run<2>& run, io::Summary& summary) override;

  void make_plate();
  void watch_points();
  std::shared_ptr<grid::Constraint<2>> make_contact(const solver::Simulation<2>& simulation) const;
  run::Stage<2> consolidation();
  run::Stage<2> compression() const;
  run::HistoryTable<2> history();
  std::vector<double> row(const Now& now);
  run::Numbers field_numbers() const;
  void report_stress(io::Summary& summary) const;
  void report_difference(io::Summary& summary) const;

  double axial_strain() const { return 1.0 - m_plate->position[1] / m_test.height; }

  BiaxialOptions m_test;
  std::shared_ptr<contact::RigidBody<2>> m_plate;
  std::shared_ptr<run::BodyReaction<2>> m_reaction;
  std::shared_ptr<run::AtRest<2>> m_ending;
  std::vector<std::shared_ptr<run::WatchedParticle<2>>> m_points;
  std::shared_ptr<run::History<2>> m_history;
  std::shared_ptr<Consolidation> m_consolidation;
};

run::Problem<2> Biaxial::problem() {
  make_plate();
  watch_points();
  m_consolidation = std::make_shared<Consolidation>();
  m_history = std::make_shared<run::History<2>>(history());
  run::Problem<2> problem{.setup = m_test.setup()};
  problem.initial_stress = [pressure = m_test.confining_pressure](const Vector<2>&) {
    return SymmetricTensor{{-pressure, -pressure, -pressure, 0.0, 0.0, 0.0}};
  };
  problem.loaded_surface = m_test.sides();
  problem.bodies = {m_plate};
  problem.constraints = {[this](const auto& simulation) { return make_contact(simulation); }};
  problem.stages = {consolidation(), compression()};
  problem.observers = {m_consolidation, m_reaction, m_points[0], m_points[1], m_history};
  problem.field_cadence =
      run::Cadence<2>(field_strains, [this](const Now&) { return axial_strain(); });
  problem.writes_fields_at_start = true;
  problem.field_numbers = [this](const Now&) { return field_numbers(); };
  return problem;
}

void Biaxial::make_plate() {
  m_plate = std::make_shared<contact::RigidBody<2>>(
      std::make_shared<geometry::HalfSpace<2>>(Vector<2>{0.0, -1.0}), Vector<2>{0.0, m_test.height},
      std::make_shared<contact::RampMotion<2>>(Vector<2>{0.0, -1.0}, m_test.ramp()));
  m_reaction = std::make_shared<run::BodyReaction<2>>(
      m_plate, contact::ContourBand{.inner = 0.1 * m_test.height, .outer = 0.4 * m_test.height});
}

void Biaxial::watch_points() {
  if (m_test.points.size() != 4)
    throw BadInput(fmt::format("-biaxial_points: {} numbers; four are needed, x,y,x,y in m",
                               m_test.points.size()));
  m_points.clear();
  for (std::size_t k = 0; k < 4; k += 2)
    m_points.push_back(
        std::make_shared<run::WatchedParticle<2>>(Vector<2>{m_test.points[k], m_test.points[k + 1]},
                                                  std::vector<std::string>{"void_ratio", "eps_q"}));
}

std::shared_ptr<grid::Constraint<2>> Biaxial::make_contact(
    const solver::Simulation<2>& simulation) const {
  const double density = simulation.particles().materials()[0]->initial_density();
  return contact_of(
      simulation, m_plate,
      {.gap_cells = m_test.gap_cells, .friction = m_test.friction, .reference_density = density});
}

/// The stress is there from the start; what is left over at the specimen's edges dies out.
run::Stage<2> Biaxial::consolidation() {
  m_ending = std::make_shared<run::AtRest<2>>(run::RestOptions<2>{
      .tolerance = m_test.tolerance, .reference_force = m_test.confining_pressure * m_test.height});
  return {.name = "consolidation",
          .ending = m_ending,
          .is_main = false,
          .damping = m_test.damping,
          .holds_bodies = true,
          .at_end = [this](const Now& now) { m_consolidation->steps = now.clock.step; }};
}

run::Stage<2> Biaxial::compression() const {
  return {.name = "compression",
          .ending = std::make_shared<run::When<2>>(
              [this](const Now&) { return axial_strain() / m_test.strain_end + 1e-9; }),
          .begins_anew = true};
}

run::HistoryTable<2> Biaxial::history() {
  std::vector<std::string> columns{"time_s", "displacement_m", "axial_strain", "vertical_stress_Pa",
                                   "vertical_stress_contour_Pa"};
  for (const char* point : {"point1", "point2"})
    for (const char* what : {"q_Pa", "p_Pa", "volumetric_strain", "void_ratio", "eps_q"})
      columns.push_back(fmt::format("{}_{}", point, what));
  columns.emplace_back("kinetic_energy_J_per_m");
  const run::Cadence<2> by_strain(row_spacing, [this](const Now&) { return axial_strain(); });
  return {.path = path("history.csv"),
          .columns = columns,
          .row = [this](const Now& now) { return row(now); },
          .cadence = by_strain.or_every(m_test.run.history_every),
          .status =
              [this](const run::History<2>& rows) {
                return fmt::format("strain {:.2f} %  stress {:.0f} kPa", 100.0 * axial_strain(),
                                   rows.last(stress_column) / 1e3);
              },
          .has_ledger = true};
}

std::vector<double> Biaxial::row(const Now& now) {
  std::vector<double> row{now.clock.time_in_stage, axial_strain() * m_test.height, axial_strain(),
                          m_reaction->take_by_impulse().force[1] / m_test.width,
                          m_reaction->take_by_contour().force[1] / m_test.width};
  for (const auto& point : m_points) {
    const run::Watched<2> seen = point->observe(now.simulation.particles());
    row.insert(row.end(), {seen.q, seen.p, seen.volumetric_strain, seen.states[0], seen.states[1]});
  }
  row.push_back(now.simulation.kinetic_energy());
  return row;
}

run::Numbers Biaxial::field_numbers() const {
  return {{"axial_strain", axial_strain()},
          {"plate_y_m", m_plate->position[1]},
          {"vertical_stress_Pa", m_history->last(stress_column)}};
}

void Biaxial::evaluate(run::Run<2>& run, io::Summary& summary) {
  summary.set("consolidation_out_of_balance", m_ending->unbalanced());
  summary.set("consolidation_steps", m_consolidation->steps);
  if (m_history->rows().empty()) return;
  report_difference(summary);
  const double differ = summary.number("stress_difference_rms");
  const double at_limits = particles_at_limits(run.simulation().particles()) /
                           static_cast<double>(run.simulation().particles().global_count());
  m_test.checks.hold("reactions", {differ, differ}, summary);
  m_test.checks.hold("limits_of_law", {at_limits, at_limits}, summary);
  if (!summary.is_withheld()) report_stress(summary);
}

void Biaxial::report_stress(io::Summary& summary) const {
  const std::vector<double> strain = m_history->column(strain_column);
  const std::vector<double> stress = m_history->column(stress_column);
  const auto peak = std::max_element(stress.begin(), stress.end());
  double residual = 0.0, count = 0.0;
  for (std::size_t k = 0; k < stress.size(); ++k) {
    if (strain[k] < strain.back() - residual_range) continue;
    residual += stress[k];
    count += 1.0;
  }
  summary.set("stress_peak_Pa", *peak);
  summary.set("strain_at_peak", strain[static_cast<std::size_t>(peak - stress.begin())]);
  summary.set("stress_residual_Pa", residual / count);
  summary.set("axial_strain_end", strain.back());
}

void Biaxial::report_difference(io::Summary& summary) const {
  double squares = 0.0, largest = 0.0;
  for (const auto& row : m_history->rows()) {
    const double difference = row[contour_column] / row[stress_column] - 1.0;
    squares += difference * difference;
    largest = std::max(largest, std::abs(difference));
  }
  const auto count = static_cast<double>(m_history->rows().size());
  summary.set("stress_difference_rms", std::sqrt(squares / count));
  summary.set("stress_difference_max", largest);
}

}  // namespace

std::unique_ptr<Case> make_biaxial() {
  return std::make_unique<Biaxial>();
}

}  // namespace mpm::cases
