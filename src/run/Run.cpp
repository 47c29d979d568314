#include "mpm/run/Run.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mpm/core/Errors.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/petsc/Log.hpp"
#include "mpm/run/InitialStress.hpp"

namespace mpm::run {
namespace {

constexpr double no_limit = std::numeric_limits<double>::max();
constexpr double largest_momentum_residual = 1e-6;  // share; round-off gives 1e-13

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

template <int dim>
Run<dim>::Run(const RunOptions& options, Problem<dim> problem)
    : m_options(options),
      m_problem(std::move(problem)),
      m_simulation(m_problem.setup),
      m_output(options.output_dir),
      m_progress(options.progress, m_simulation.communicator().is_root()),
      m_schedule(options.checkpoint, m_simulation.communicator().is_root()),
      m_times_left(options.particle_output_times) {
  check_counted_stage();
  std::sort(m_times_left.begin(), m_times_left.end());
  if (m_problem.arrange) {
    m_problem.arrange(m_simulation);
    m_simulation.particles().migrate();
  }
  m_initial_mass = m_simulation.total_mass();
  if (!m_problem.loaded_surface.empty()) m_simulation.boundary().add(m_problem.loaded_surface);
  for (const auto& make : m_problem.constraints) m_simulation.add_constraint(make(m_simulation));
  prescribe_initial_stress();
  if (m_problem.body_force) m_simulation.set_body_force(m_problem.body_force);
  m_simulation.open_ledger();
  put_back();
}

template <int dim>
void Run<dim>::prescribe_initial_stress() {
  if (!m_problem.initial_stress) return;
  try {
    prescribe_stress<dim>(m_simulation, m_problem.initial_stress);
  } catch (const BadInput& error) {
    if (m_problem.initial_stress_remedy.empty()) throw;
    throw BadInput(fmt::format("{} ({})", m_problem.initial_stress_remedy, error.what()));
  }
}

template <int dim>
void Run<dim>::check_counted_stage() const {
  if (m_options.counted_stage.empty()) return;
  std::vector<std::string> names;
  for (const Stage<dim>& stage : m_problem.stages) names.push_back(stage.name);
  if (std::ranges::find(names, m_options.counted_stage) == names.end())
    throw BadInput(fmt::format("-counted_stage {}: there is no such stage; allowed are {}",
                               m_options.counted_stage, fmt::join(names, ", ")));
}

template <int dim>
bool Run<dim>::counts(const Stage<dim>& stage) const {
  return m_options.counted_stage.empty() ? stage.is_main : stage.name == m_options.counted_stage;
}

/// A failure with stage, step and time, where they are not known yet.
template <int dim>
NumericalFailure Run<dim>::placed(const NumericalFailure& failure) const {
  auto details = nlohmann::ordered_json::parse(failure.details());
  const nlohmann::ordered_json place{{"kind", "other"},
                                     {"message", failure.what()},
                                     {"step", m_clock.step},
                                     {"last_good_step", m_clock.step},
                                     {"time_s", m_clock.time}};
  for (const auto& [key, value] : place.items())
    if (!details.contains(key)) details[key] = value;
  const auto stage = static_cast<std::size_t>(m_clock.stage);
  if (stage < m_problem.stages.size()) details["stage"] = m_problem.stages[stage].name;
  return NumericalFailure(failure.what(), details.dump());
}

template <int dim>
void Run<dim>::go(Fields at_end) {
  try {
    go_through(at_end);
  } catch (const NumericalFailure& failure) {
    throw placed(failure);
  }
}

template <int dim>
void Run<dim>::go_through(Fields at_end) {
  if (m_checkpoint.empty())
    for (const auto& observer : m_problem.observers) observer->begin(moment());
  else
    go_on();
  for (std::size_t k = static_cast<std::size_t>(m_clock.stage); k < m_problem.stages.size(); ++k)
    if (!follow(m_problem.stages[k])) break;
  for (const auto& observer : m_problem.observers) observer->end(moment());
  if (at_end == Fields::written) write_fields();
}

template <int dim>
void Run<dim>::begin(const Stage<dim>& stage) {
  const bool was_main = m_has_main_begun;
  m_has_main_begun = m_has_main_begun || stage.is_main;
  m_clock.begin_stage(counts(stage));
  if (stage.begins_at_rest || stage.begins_anew) m_simulation.start_from_rest();
  if (stage.begins_anew) m_clock.time = 0.0;
  if (stage.gravity) m_simulation.set_gravity(*stage.gravity);
  m_simulation.set_damping(stage.damping);
  stage.ending->begin(moment());
  if (!m_has_main_begun) return;
  for (const auto& observer : m_problem.observers) observer->begin_stage(moment());
  if (m_problem.writes_fields_at_start && !was_main) write_fields();
}

/// Returns false if the run as a whole is over.
template <int dim>
bool Run<dim>::follow(const Stage<dim>& stage) {
  if (!std::exchange(m_is_within_stage, false)) begin(stage);
  const petsc::Stage logged(stage.name);
  m_progress.begin(stage.name, m_clock.step);
  double share = stage.ending->share_done(moment());
  while (share < 1.0 && !is_over()) {
    write_due_checkpoint();
    take_step(stage);
    share = stage.ending->share_done(moment());
    m_progress.update(share, m_clock.step, status(stage));
  }
  m_progress.end(m_clock.step);
  ++m_clock.stage;
  if (is_over()) return false;
  if (stage.at_end) stage.at_end(moment());
  return true;
}

template <int dim>
void Run<dim>::take_step(const Stage<dim>& stage) {
  const double begin = MPI_Wtime();
  const double dt = m_simulation.plan(longest_step(stage));
  load_surface();
  for (const auto& body : m_problem.bodies)
    stage.holds_bodies ? body->stand_still() : body->begin_step(dt);
  m_simulation.tell(m_schedule.wishes());
  m_clock.advance(m_simulation.advance(m_clock.time, dt));
  m_wishes |= m_simulation.heard();
  for (const auto& body : m_problem.bodies) body->end_step(m_clock.dt, m_clock.momentum_dt);
  m_seconds_in_steps += MPI_Wtime() - begin;
  stage.ending->after_step(moment());
  if (m_has_main_begun)
    for (const auto& observer : m_problem.observers) observer->after_step(moment());
  write_due_fields();
}

template <int dim>
void Run<dim>::load_surface() {
  if (!m_problem.surface_pressure) return;
  const auto view = m_simulation.boundary().view();
  std::fill_n(view.pressure, view.count, m_problem.surface_pressure(m_clock.time));
}

/// So long that the step meets the ends and output times exactly.
template <int dim>
double Run<dim>::longest_step(const Stage<dim>& stage) const {
  double left = stage.ending->time_left(m_clock);
  if (m_clock.is_counting && m_options.end_time)
    left = std::min(left, *m_options.end_time - m_clock.counted_time);
  if (m_clock.is_counting && !m_times_left.empty())
    left = std::min(left, m_times_left.front() - m_clock.counted_time);
  return std::min(stage.longest_step, left > 0.0 ? left : no_limit);
}

template <int dim>
bool Run<dim>::is_over() const {
  if (!m_clock.is_counting) return false;
  if (m_options.end_time && has_come(m_clock.counted_time, *m_options.end_time)) return true;
  return m_options.max_steps > 0 && m_clock.counted_steps >= m_options.max_steps;
}

template <int dim>
void Run<dim>::write_due_fields() {
  bool due =
      m_has_main_begun && m_problem.field_cadence && m_problem.field_cadence->is_due(moment());
  if (m_clock.is_counting) {
    const std::int64_t every = m_options.particle_output_every;
    due = due || (every > 0 && m_clock.counted_steps % every == 0);
    while (!m_times_left.empty() && has_come(m_clock.counted_time, m_times_left.front())) {
      m_times_left.erase(m_times_left.begin());
      due = true;
    }
  }
  if (due) write_fields();
}

/// Every moment once.
template <int dim>
void Run<dim>::write_fields() {
  if (m_last_written == m_clock.step) return;
  m_last_written = m_clock.step;
  check_ledger();
  const Numbers numbers = m_problem.field_numbers ? m_problem.field_numbers(moment()) : Numbers{};
  m_output.write({m_clock.time, m_clock.step, numbers}, m_simulation.particles(),
                 m_simulation.grid(), m_simulation.step().nodal_sums());
}

template <int dim>
std::string Run<dim>::status(const Stage<dim>& stage) const {
  std::string text = stage.ending->status();
  if (!m_has_main_begun) return text;
  for (const auto& observer : m_problem.observers) {
    const std::string more = observer->status();
    if (!text.empty() && !more.empty()) text += "  ";
    text += more;
  }
  return text;
}

template <int dim>
void Run<dim>::summarise(io::Summary& summary) const {
  const auto particles = static_cast<double>(m_simulation.particles().global_count());
  const double seconds = m_simulation.communicator().maximum(m_seconds_in_steps);
  summary.set("ranks", m_simulation.communicator().size());
  summary.set("instruction_set", std::string(simd::instruction_set));
  summary.set("courant", m_options.courant());
  summary.set("cells", m_simulation.grid().global_cells());
  summary.set("particles", m_simulation.particles().global_count());
  summary.set("particles_lost", 0);  // a lost particle stops the run
  summary.set("load_max_over_mean", m_simulation.imbalance());
  summary.set("rebalancings", m_simulation.rebalancings());
  summary.set("steps", m_clock.step);
  summary.set("simulated_time_s", m_clock.time);
  summary.set("step_loop_s", seconds);
  summary.set("particle_updates_per_s",
              seconds > 0.0 ? particles * static_cast<double>(m_clock.step) / seconds : 0.0);
  summary.set("bytes_per_particle", m_simulation.particles().bytes_per_particle());
  summary.set("peak_memory_bytes", m_simulation.communicator().sum(peak_memory_bytes()));
  summary.set("mass_kg", m_simulation.total_mass());
  summary.set("mass_change_share", m_simulation.total_mass() / m_initial_mass - 1.0);
  const Vector<dim> momentum = m_simulation.momentum();
  for (int d = 0; d < dim; ++d)
    summary.set(std::string("momentum_") + "xyz"[d] + "_N_s", momentum[d]);
  summary.set("kinetic_energy_J", m_simulation.kinetic_energy());
  summarise_ledger(summary);
}

/// What particles have as momentum is what forces have given them, or something is wrong.
template <int dim>
void Run<dim>::check_ledger() const {
  const double share = m_simulation.ledger().momentum_residual_share;
  if (!(share <= largest_momentum_residual))
    throw NumericalFailure(
        fmt::format(
            "at step {} the particles' momentum is not what forces, walls, bodies and damping have "
            "given them: {:.3g} of it is unaccounted for, {} is allowed; this is a fault of the "
            "program",
            m_clock.step, share, largest_momentum_residual),
        failure_kind("momentum_unaccounted", "report it with used.opts"));
}

template <int dim>
void Run<dim>::summarise_ledger(io::Summary& summary) const {
  for (const auto& [name, value] : solver::entries(m_simulation.ledger()))
    summary.set("ledger_" + name, value);
}

template class Run<1>;
template class Run<2>;
template class Run<3>;

}  // namespace mpm::run
