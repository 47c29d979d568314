#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <stdexcept>

#include "mpm/core/Errors.hpp"
#include "mpm/run/Checkpoint.hpp"
#include "mpm/run/Run.hpp"

namespace mpm::run {
namespace {

/// Whether a file lies in a directory, which need not be there.
bool lies_in(const std::string& file, const std::string& directory) {
  namespace fs = std::filesystem;
  std::error_code ignored;  // of two that cannot be compared one is not there
  const fs::path parent = fs::path(file).parent_path();
  return fs::equivalent(parent.empty() ? fs::path(".") : parent, directory, ignored);
}

static_assert(CheckpointSchedule::end_by_limit < 1 << solver::Simulation<1>::heard_bits);

constexpr const char* reason(int wishes) {
  return (wishes & CheckpointSchedule::end_asked) != 0 ? "by a signal" : "for -wall_time_limit";
}

}  // namespace

template <int dim>
void Run<dim>::persist(Archive& archive) {
  archive.group("clock", [&] { m_clock.persist(archive); });
  for (std::size_t k = 0; k < m_problem.bodies.size(); ++k)
    archive.group(fmt::format("body{}", k), [&] { m_problem.bodies[k]->persist(archive); });
  archive.group("simulation", [&] { m_simulation.persist(archive); });
  archive("has_main_begun", m_has_main_begun);
  archive("last_written", m_last_written);
  archive.largest("seconds_in_steps", m_seconds_in_steps);
  archive.group("output", [&] { m_output.persist(archive); });
  if (m_problem.field_cadence)
    archive.group("fields", [&] { m_problem.field_cadence->persist(archive); });
  for (std::size_t k = 0; k < m_problem.stages.size(); ++k)
    archive.group(fmt::format("stage{}", k), [&] { m_problem.stages[k].ending->persist(archive); });
  for (std::size_t k = 0; k < m_problem.observers.size(); ++k)
    archive.group(fmt::format("observer{}", k), [&] { m_problem.observers[k]->persist(archive); });
}

/// Observers see the beginning first: what they find there and do not save stays true.
template <int dim>
void Run<dim>::put_back() {
  const petsc::Communicator& ranks = m_simulation.communicator();
  const auto path = checkpoint_to_go_on_from(m_options.checkpoint, m_options.output_dir, ranks);
  if (!path) return;
  const Checkpoint checkpoint(*path, ranks);
  checkpoint.check(m_options.checkpoint.identity());
  for (const auto& observer : m_problem.observers) observer->begin(moment());
  checkpoint.put_back(m_simulation);
  Archive archive = checkpoint.archive();
  try {
    persist(archive);
    if (const auto left = archive.left(); !left.empty())
      throw std::logic_error(fmt::format("'{}' is not known", fmt::join(left, "', '")));
  } catch (const std::logic_error& fault) {
    checkpoint.refuse(
        fmt::format("was written by another program, {}: {}", checkpoint.program(), fault.what()),
        "go on with that program");
  }
  m_checkpoint = *path;
  m_checkpoint_program = checkpoint.program();
  m_goes_on_in_place = ranks.all(!ranks.is_root() || lies_in(*path, m_options.output_dir));
  m_is_within_stage = true;
  m_schedule.written(m_clock.step);
  std::erase_if(m_times_left, [this](double time) {
    return m_clock.counted_steps > 0 && has_come(m_clock.counted_time, time);
  });
}

template <int dim>
void Run<dim>::go_on() {
  m_progress.note(
      fmt::format("goes on from {}: step {}, {:.6g} s", m_checkpoint, m_clock.step, m_clock.time));
  if (m_checkpoint_program != program_name())
    m_progress.note(fmt::format("it was written by {}, this is {}: round-off may differ",
                                m_checkpoint_program, program_name()));
  const int first = m_output.go_on(m_simulation.particles(), m_simulation.grid());
  if (first > 0)
    m_progress.note(
        fmt::format("the first {} outputs of fields are not in {}", first, m_options.output_dir));
  for (const auto& observer : m_problem.observers) observer->go_on(moment());
}

/// Before a step, when all that the last one has left on the nodes has been read.
template <int dim>
void Run<dim>::write_due_checkpoint() {
  if (!m_schedule.is_due(m_clock.step, m_wishes)) return;
  const int wishes = std::exchange(m_wishes, 0);
  write_checkpoint();
  if ((wishes & CheckpointSchedule::asked) != 0)
    m_progress.note(fmt::format("checkpoint at step {}", m_clock.step));
  if (!CheckpointSchedule::has_to_end(wishes)) return;
  m_progress.end(m_clock.step);
  throw StoppedEarly(fmt::format("stopped {} after step {}; the checkpoint is {}", reason(wishes),
                                 m_clock.step, checkpoint_path(m_options.output_dir)));
}

template <int dim>
void Run<dim>::write_checkpoint() {
  Archive archive;
  persist(archive);
  run::write_checkpoint<dim>(checkpoint_path(m_options.output_dir), m_options.checkpoint.identity(),
                             {m_clock.step, m_clock.time}, m_simulation, archive);
  m_schedule.written(m_clock.step);
}

#define MPM_INSTANTIATE(dim)                      \
  template void Run<dim>::persist(Archive&);      \
  template void Run<dim>::put_back();             \
  template void Run<dim>::go_on();                \
  template void Run<dim>::write_due_checkpoint(); \
  template void Run<dim>::write_checkpoint()
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::run
