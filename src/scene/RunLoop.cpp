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
RunLoop<dim>::RunLoop(const run::RunOptions& options, solver::Simulation<dim>& simulation)
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
  if (!m_clock.is_counting) return false;
  const bool late =
      m_options.end_time && m_clock.counted_time >= *m_options.end_time * (1.0 - 1e-14);
  return late || (m_options.max_steps > 0 && m_clock.counted_steps >= m_options.max_steps);
}

/// So long that the step meets the ends and output times exactly.
template <int dim>
double RunLoop<dim>::longest_step(const Stage& stage) const {
  double limit = std::numeric_limits<double>::max();
  if (stage.end_time > 0.0) limit = std::min(limit, stage.end_time - m_clock.time_in_stage);
  if (m_clock.is_counting && m_options.end_time)
    limit = std::min(limit, *m_options.end_time - m_clock.counted_time);
  if (m_clock.is_counting && !m_times_left.empty())
    limit = std::min(limit, m_times_left.front() - m_clock.counted_time);
  return std::min(stage.longest_step, limit > 0.0 ? limit : stage.longest_step);
}

template <int dim>
void RunLoop<dim>::write_due_fields() {
  if (!m_clock.is_counting) return;
  bool due = m_options.particle_output_every > 0 &&
             m_clock.counted_steps % m_options.particle_output_every == 0;
  while (!m_times_left.empty() && m_clock.counted_time >= m_times_left.front() * (1.0 - 1e-14)) {
    m_times_left.erase(m_times_left.begin());
    due = true;
  }
  if (due)
    write_fields(m_output_numbers ? m_output_numbers()
                                  : std::vector<std::pair<std::string, double>>{});
}

template <int dim>
bool RunLoop<dim>::run(const Stage& stage) {
  m_clock.begin_stage(m_options.counted_stage.empty() ? stage.is_main
                                                      : stage.name == m_options.counted_stage);
  const petsc::Stage logged(stage.name);
  m_progress.begin(stage.name, m_clock.step);
  double share = stage.share_done();
  while (share < 1.0 && !is_over()) {
    const double begin = MPI_Wtime();
    const double dt = m_simulation.plan(longest_step(stage));
    if (stage.before_step) stage.before_step(dt);
    m_clock.advance(m_simulation.advance(m_clock.time, dt));
    m_seconds_in_steps += MPI_Wtime() - begin;
    if (stage.after_step) stage.after_step();
    write_due_fields();
    share = stage.share_done();
    m_progress.update(share, m_clock.step, stage.status ? stage.status() : "");
  }
  m_progress.end(m_clock.step);
  ++m_clock.stage;
  return !is_over();
}

template <int dim>
void RunLoop<dim>::write_fields(std::vector<std::pair<std::string, double>> numbers) {
  if (m_last_written == m_clock.step) return;
  m_last_written = m_clock.step;
  m_output.write({m_clock.time, m_clock.step, std::move(numbers)}, m_simulation.particles(),
                 m_simulation.grid(), m_simulation.step().nodal_sums());
}

template <int dim>
void RunLoop<dim>::summarise(io::Summary& summary) const {
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
  summary.set("steps", m_clock.step);
  summary.set("simulated_time_s", m_clock.time);
  summary.set("step_loop_s", seconds);
  summary.set("particle_updates_per_s",
              seconds > 0.0 ? particles * static_cast<double>(m_clock.step) / seconds : 0.0);
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
