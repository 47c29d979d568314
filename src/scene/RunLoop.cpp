#include "mpm/scene/RunLoop.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "mpm/core/Simd.hpp"
#include "mpm/petsc/Log.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::scene {
namespace {

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

template <int dim>
RunLoop<dim>::RunLoop(const RunOptions& options, solver::Simulation<dim>& simulation)
    : m_options(options),
      m_simulation(simulation),
      m_output(options.output_dir),
      m_progress(options.progress),
      m_times_left(options.particle_output_times),
      m_initial_mass(simulation.total_mass()) {
  std::sort(m_times_left.begin(), m_times_left.end());
}

template <int dim>
bool RunLoop<dim>::is_over() const {
  const solver::RunState& state = m_simulation.state();
  const bool late = m_options.end_time && state.time >= *m_options.end_time * (1.0 - 1e-14);
  return late || (m_options.max_steps > 0 && state.step >= m_options.max_steps);
}

/// Cuts the next step so that it meets the ends and output times exactly.
template <int dim>
void RunLoop<dim>::limit_step(const Stage& stage) {
  const solver::RunState& state = m_simulation.state();
  double limit = std::numeric_limits<double>::max();
  if (stage.end_time > 0.0) limit = std::min(limit, stage.end_time - state.time_in_stage);
  if (m_options.end_time) limit = std::min(limit, *m_options.end_time - state.time);
  if (!m_times_left.empty()) limit = std::min(limit, m_times_left.front() - state.time);
  if (limit > 0.0) m_simulation.limit_next_step(limit);
}

template <int dim>
void RunLoop<dim>::write_due_fields() {
  const solver::RunState& state = m_simulation.state();
  bool due =
      m_options.particle_output_every > 0 && state.step % m_options.particle_output_every == 0;
  while (!m_times_left.empty() && state.time >= m_times_left.front() * (1.0 - 1e-14)) {
    m_times_left.erase(m_times_left.begin());
    due = true;
  }
  if (due)
    write_fields(m_output_numbers ? m_output_numbers()
                                  : std::vector<std::pair<std::string, double>>{});
}

template <int dim>
bool RunLoop<dim>::run(const Stage& stage) {
  solver::RunState& state = m_simulation.state();
  state.steps_in_stage = 0;
  state.time_in_stage = 0.0;
  const petsc::Stage logged(stage.name);
  m_progress.begin(stage.name, state.step);
  double share = stage.share_done();
  while (share < 1.0 && !is_over()) {
    if (stage.before_step) stage.before_step();
    limit_step(stage);
    const double begin = MPI_Wtime();
    m_simulation.advance();
    m_seconds_in_steps += MPI_Wtime() - begin;
    if (stage.after_step) stage.after_step();
    write_due_fields();
    share = stage.share_done();
    m_progress.update(share, state.step, stage.status ? stage.status() : "");
  }
  m_progress.end(state.step);
  ++state.stage;
  return !is_over();
}

template <int dim>
void RunLoop<dim>::write_fields(std::vector<std::pair<std::string, double>> numbers) {
  const solver::RunState& state = m_simulation.state();
  m_output.write({state.time, state.step, std::move(numbers)}, m_simulation.particles(),
                 m_simulation.grid(), m_simulation.step().nodal_sums());
}

template <int dim>
void RunLoop<dim>::summarise(io::Summary& summary) const {
  const solver::RunState& state = m_simulation.state();
  const auto particles = static_cast<double>(m_simulation.particles().global_count());
  const double seconds = petsc::maximum(m_seconds_in_steps);
  summary.set("ranks", petsc::world_size());
  summary.set("instruction_set", std::string(simd::instruction_set));
  summary.set("courant", m_options.courant());
  summary.set("cells", m_simulation.grid().global_cells());
  summary.set("particles", m_simulation.particles().global_count());
  summary.set("particles_lost", 0);  // a lost particle stops the run
  summary.set("load_max_over_mean", m_simulation.imbalance());
  summary.set("rebalancings", m_simulation.rebalancings());
  summary.set("steps", state.step);
  summary.set("simulated_time_s", state.time);
  summary.set("step_loop_s", seconds);
  summary.set("particle_updates_per_s",
              seconds > 0.0 ? particles * static_cast<double>(state.step) / seconds : 0.0);
  summary.set("bytes_per_particle", m_simulation.particles().bytes_per_particle());
  summary.set("peak_memory_bytes", petsc::sum(peak_memory_bytes()));
  summary.set("mass_kg", m_simulation.total_mass());
  summary.set("mass_change_share", m_simulation.total_mass() / m_initial_mass - 1.0);
  const Vector<dim> momentum = m_simulation.momentum();
  for (int d = 0; d < dim; ++d)
    summary.set(std::string("momentum_") + "xyz"[d] + "_N_s", momentum[d]);
  summary.set("kinetic_energy_J", m_simulation.kinetic_energy());
}

template class RunLoop<1>;
template class RunLoop<2>;
template class RunLoop<3>;

}  // namespace mpm::scene
