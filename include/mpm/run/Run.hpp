#pragma once

#include <limits>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/io/FieldOutput.hpp"
#include "mpm/io/Summary.hpp"
#include "mpm/run/CheckpointSchedule.hpp"
#include "mpm/run/Problem.hpp"
#include "mpm/run/Progress.hpp"
#include "mpm/run/RunOptions.hpp"

namespace mpm::run {

/// Whether particles and grid are written when a run is over.
enum class Fields { written, left_out };

/// Takes a problem through its stages: owns simulation, clock, observers, outputs and progress.
template <int dim>
class Run {
 public:
  /// Makes the simulation and brings it to its initial state, or to that of the checkpoint from
  /// which it goes on; writes nothing. Throws BadInput where the problem cannot be run, or the
  /// checkpoint is none of it. Collective.
  Run(const RunOptions& options, Problem<dim> problem);

  /// All stages, up to the last one or the limits of the options. Throws StoppedEarly where signals
  /// or -wall_time_limit end it, with a checkpoint. Collective.
  void go(Fields at_end = Fields::written);

  /// Ranks, cells, particles, steps, speed and memory; mass and momentum at the end. Collective.
  void summarise(io::Summary& summary) const;

  const solver::Simulation<dim>& simulation() const { return m_simulation; }
  solver::Simulation<dim>& simulation() { return m_simulation; }
  const Clock& clock() const { return m_clock; }
  Moment<dim> moment() { return {m_simulation, m_clock}; }

  /// Whether files in the output directory are its own, up to the checkpoint from which it goes on.
  bool goes_on_in_place() const { return m_goes_on_in_place; }

  /// Saves or puts back all but particles and the owners of cells.
  void persist(Archive& archive);

 private:
  void go_through(Fields at_end);
  NumericalFailure placed(const NumericalFailure& failure) const;
  using Stages = std::vector<Stage<dim>>;

  void prescribe_initial_stress();
  void put_back();
  void go_on();
  void write_due_checkpoint();
  void write_checkpoint();
  void check_counted_stage() const;
  bool counts(const Stage<dim>& stage) const;
  void begin(const Stage<dim>& stage);
  bool follow(const Stage<dim>& stage);
  void take_step(const Stage<dim>& stage);
  double longest_step(const Stage<dim>& stage) const;
  bool is_over() const;
  void write_due_fields();
  void write_fields();
  std::string status(const Stage<dim>& stage) const;
  void load_surface();
  void check_ledger() const;
  void summarise_ledger(io::Summary& summary) const;

  const RunOptions& m_options;
  Problem<dim> m_problem;
  solver::Simulation<dim> m_simulation;
  Clock m_clock;
  io::FieldOutput<dim> m_output;
  bool m_has_main_begun = false;
  long long m_last_written = -1;  ///< step
  Progress m_progress;
  CheckpointSchedule m_schedule;
  int m_wishes = 0;                  ///< of all ranks, see CheckpointSchedule
  std::string m_checkpoint;          ///< from which the run goes on; empty where it begins
  std::string m_checkpoint_program;  ///< that wrote it
  bool m_goes_on_in_place = false;   ///< in the directory of that
  bool m_is_within_stage = false;    ///< when put back
  std::vector<double> m_times_left;
  double m_seconds_in_steps = 0.0;
  double m_initial_mass;
};

extern template class Run<1>;
extern template class Run<2>;
extern template class Run<3>;

}  // namespace mpm::run
