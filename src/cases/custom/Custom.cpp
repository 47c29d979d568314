#include <cmath>
#include <utility>

#include "Lists.hpp"
#include "Model.hpp"
#include "Rows.hpp"
#include "mpm/cases/Evidence.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace custom {
namespace {

constexpr double row_spacing = 0.005;  // of a stage, between rows of history.csv
constexpr double field_spacing = 0.1;  // of a stage, between outputs of particles and grid

/// A problem of one dimension, two or three that options put together.
template <int dim>
class CustomCase : public GridCase<dim> {
 public:
  explicit CustomCase(const CustomOptions& options) : m_custom(options) {}

  void declare(options::OptionSet&) override {}  // the options are there

  std::string answer(const io::Summary& summary) const override {
    std::string text;
    for (const auto& body : m_custom.bodies)
      text += fmt::format("{}{}: moved {:.4g} m, largest force {:.4g} {}", text.empty() ? "" : "; ",
                          body->name, summary.number(fmt::format("body_{}_way_m", body->name)),
                          summary.number(largest_force_key(body->name)), force_unit<dim>);
    if (!text.empty()) return text;
    return fmt::format("kinetic energy at the end {:.4g} J", summary.number("kinetic_energy_J"));
  }

 private:
  using Now = run::Moment<dim>;

  const run::RunOptions& run_options() const override { return m_custom.run; }
  run::Problem<dim> problem() override;
  void evaluate(run::Run<dim>& run, io::Summary& summary) override;

  std::vector<Vector<dim>> watched_points() const;
  std::vector<run::Stage<dim>> stages();
  run::Stage<dim> stage(std::size_t k);
  std::shared_ptr<run::Ending<dim>> ending_of(const StageOptions& stage) const;
  std::shared_ptr<run::Ending<dim>> end_of_way(const StageOptions& stage, std::size_t colon) const;
  bool begins_anew(std::size_t k) const;
  bool is_main(std::size_t k) const;
  double progress(const Now& now) const;
  run::HistoryTable<dim> history();
  run::Numbers field_numbers() const;
  void hold_evidence(const particles::Particles<dim>& particles, io::Summary& summary) const;
  void report(const Body<dim>& body, std::size_t first_column, io::Summary& summary) const;
  static std::string largest_force_key(const std::string& body) {
    return fmt::format("body_{}_largest_force_{}", body, force_unit<dim>);
  }

  const CustomOptions& m_custom;
  std::optional<Model<dim>> m_model;
  std::shared_ptr<Rows<dim>> m_rows;
  std::shared_ptr<run::History<dim>> m_history;
  std::vector<std::shared_ptr<run::Ending<dim>>> m_endings;
};

template <int dim>
run::Problem<dim> CustomCase<dim>::problem() {
  m_model.emplace(m_custom);
  m_rows = std::make_shared<Rows<dim>>(m_model->bodies(), watched_points());
  run::Problem<dim> problem{.setup = m_model->setup()};
  problem.arrange = [this](auto& simulation) { m_model->check_filling(simulation); };
  problem.initial_stress = m_model->initial_stress();
  problem.initial_stress_remedy =
      "a region cannot bear its stress at rest: take a -region_NAME_K0 nearer to 1, a "
      "-region_NAME_stress or a stronger soil";
  problem.loaded_surface = m_model->loaded_surface();
  for (const Body<dim>& body : m_model->bodies()) {
    problem.bodies.push_back(body.rigid);
    problem.constraints.push_back([this, body](const auto& simulation) {
      contact::ContactOptions options = body.contact;
      options.reference_density = m_model->smallest_density();
      return contact_of<dim>(simulation, body.rigid, options);
    });
  }
  problem.stages = stages();
  m_history = std::make_shared<run::History<dim>>(history());
  problem.observers = m_rows->observers();
  problem.observers.push_back(m_history);
  problem.field_cadence =
      run::Cadence<dim>(field_spacing, [this](const Now& now) { return progress(now); });
  problem.writes_fields_at_start = true;
  problem.field_numbers = [this](const Now&) { return field_numbers(); };
  return problem;
}

template <int dim>
std::vector<Vector<dim>> CustomCase<dim>::watched_points() const {
  std::vector<Vector<dim>> points;
  if (m_custom.watched.size() % dim != 0)
    throw BadInput(fmt::format("-watch: {} numbers are no points of {} coordinates",
                               m_custom.watched.size(), dim));
  for (std::size_t k = 0; k < m_custom.watched.size(); k += dim)
    points.push_back(vector_from<dim>(m_custom.watched, k));
  return points;
}

template <int dim>
std::vector<run::Stage<dim>> CustomCase<dim>::stages() {
  m_endings.clear();
  std::vector<run::Stage<dim>> stages;
  for (std::size_t k = 0; k < m_custom.stages.size(); ++k) stages.push_back(stage(k));
  m_model->check_ways();
  return stages;
}

template <int dim>
run::Stage<dim> CustomCase<dim>::stage(std::size_t k) {
  const StageOptions& options = *m_custom.stages[k];
  m_endings.push_back(ending_of(options));
  return {.name = options.name,
          .ending = m_endings.back(),
          .is_main = is_main(k),
          .damping = options.damping,
          .holds_bodies = options.bodies == Bodies::held,
          .begins_at_rest = options.begin == Begin::at_rest,
          .begins_anew = begins_anew(k)};
}

template <int dim>
bool CustomCase<dim>::begins_anew(std::size_t k) const {
  const Begin begin = m_custom.stages[k]->begin;
  if (begin != Begin::automatic) return begin == Begin::anew;
  return k > 0 && m_custom.stages[k - 1]->is_settling();
}

/// What comes before all that moves is preparation, unless there is nothing else.
template <int dim>
bool CustomCase<dim>::is_main(std::size_t k) const {
  return !m_custom.stages[k]->is_settling() || k + 1 == m_custom.stages.size();
}

template <int dim>
std::shared_ptr<run::Ending<dim>> CustomCase<dim>::ending_of(const StageOptions& stage) const {
  if (stage.is_settling())
    return std::make_shared<run::AtRest<dim>>(run::RestOptions<dim>{
        .tolerance = stage.rest_tolerance, .reference_force = stage.rest_force.value_or(0.0)});
  const std::size_t colon = stage.until.find(':');
  if (colon != std::string::npos) return end_of_way(stage, colon);
  double time = 0.0;
  const std::string fault = options::read(stage.until, options::positive(), time);
  if (!fault.empty())
    throw BadInput(fmt::format(
        "-stage_{}_until {}: is neither the word rest, a time in s nor BODY:DISTANCE in m",
        stage.name, stage.until));
  return std::make_shared<run::AfterTime<dim>>(time);
}

template <int dim>
std::shared_ptr<run::Ending<dim>> CustomCase<dim>::end_of_way(const StageOptions& stage,
                                                              std::size_t colon) const {
  const std::string name = stage.until.substr(0, colon);
  const auto refuse = [&](const std::string& why) {
    throw BadInput(fmt::format("-stage_{}_until {}: {}", stage.name, stage.until, why));
  };
  double distance = 0.0;
  const std::string fault =
      options::read(std::string_view(stage.until).substr(colon + 1), options::positive(), distance);
  if (!fault.empty()) refuse("the distance " + fault + "; it is positive, in m");
  const auto body = std::ranges::find(m_model->bodies(), name, &Body<dim>::name);
  if (body == m_model->bodies().end())
    refuse(fmt::format("there is no body {}; allowed are {}", name,
                       fmt::join(m_custom.body_names, ", ")));
  if (!body->moves || stage.bodies == Bodies::held)
    refuse("this body does not move in this stage; give it a velocity and let it go");
  return std::make_shared<run::AfterWay<dim>>(body->rigid, distance);
}

/// Stages that are over and the share of the present one.
template <int dim>
double CustomCase<dim>::progress(const Now& now) const {
  const auto k = static_cast<std::size_t>(now.clock.stage);
  return static_cast<double>(k) + (k < m_endings.size() ? m_endings[k]->share_done(now) : 0.0);
}

template <int dim>
run::HistoryTable<dim> CustomCase<dim>::history() {
  const run::Cadence<dim> by_progress(row_spacing,
                                      [this](const Now& now) { return progress(now); });
  return {.path = this->path("history.csv"),
          .columns = m_rows->columns(),
          .row = [this](const Now& now) { return m_rows->row(now); },
          .cadence = by_progress.or_every(m_custom.run.history_every),
          .columns_before_clock = Rows<dim>::of_time,
          .has_ledger = true};
}

template <int dim>
run::Numbers CustomCase<dim>::field_numbers() const {
  run::Numbers numbers;
  for (const Body<dim>& body : m_model->bodies()) {
    for (int d = 0; d < dim; ++d)
      numbers.emplace_back(fmt::format("{}_{}_m", body.name, "xyz"[d]), body.rigid->position[d]);
    if (dim == 2) numbers.emplace_back(body.name + "_angle_rad", body.rigid->angle);
  }
  return numbers;
}

template <int dim>
void CustomCase<dim>::evaluate(run::Run<dim>& run, io::Summary& summary) {
  hold_evidence(run.simulation().particles(), summary);
  if (summary.is_withheld()) return;
  for (std::size_t k = 0; k < m_model->bodies().size(); ++k)
    report(m_model->bodies()[k], m_rows->first_of(k), summary);
}

/// At the end of the run.
template <int dim>
void CustomCase<dim>::hold_evidence(const particles::Particles<dim>& particles,
                                    io::Summary& summary) const {
  const auto all = static_cast<double>(particles.global_count());
  double inside = 0.0;
  for (const Body<dim>& body : m_model->bodies())
    inside += particles_inside(particles, *body.rigid, 0.5 * m_model->smallest_cell()) / all;
  const double at_limits = particles_at_limits(particles) / all;
  m_custom.checks.hold("particles_in_body", {inside, inside}, summary);
  m_custom.checks.hold("limits_of_law", {at_limits, at_limits}, summary);
}

template <int dim>
void CustomCase<dim>::report(const Body<dim>& body, std::size_t first_column,
                             io::Summary& summary) const {
  double square = 0.0, largest = 0.0;
  for (int d = 0; d < dim; ++d) square += std::pow(body.rigid->position[d] - body.start[d], 2);
  for (const auto& row : m_history->rows()) {
    double force = 0.0;
    for (std::size_t d = 0; d < dim; ++d)
      force += std::pow(row[first_column + Rows<dim>::force + d], 2);
    largest = std::max(largest, std::sqrt(force));
  }
  summary.set(fmt::format("body_{}_way_m", body.name), std::sqrt(square));
  summary.set(largest_force_key(body.name), largest);
  if (m_history->rows().empty()) return;
  const std::vector<std::string> names = Rows<dim>::body_columns(body.name);
  for (std::size_t k = 0; k < names.size(); ++k)
    summary.set("body_" + names[k], m_history->last(first_column + k));
}

std::unique_ptr<Case> case_of(const CustomOptions& options) {
  if (options.dimension == 1) return std::make_unique<CustomCase<1>>(options);
  if (options.dimension == 2) return std::make_unique<CustomCase<2>>(options);
  return std::make_unique<CustomCase<3>>(options);
}

/// The case of the dimension that its options ask for.
class Custom : public Case {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void prepare() override {
    m_case = case_of(m_options);
    m_case->prepare();
  }
  bool goes_on_in_place() const override { return m_case->goes_on_in_place(); }
  void run(io::Summary& summary) override { m_case->run(summary); }
  std::string answer(const io::Summary& summary) const override { return m_case->answer(summary); }

 private:
  CustomOptions m_options;
  std::unique_ptr<Case> m_case;
};

}  // namespace
}  // namespace custom

std::unique_ptr<Case> make_custom() {
  return std::make_unique<custom::Custom>();
}

}  // namespace mpm::cases
