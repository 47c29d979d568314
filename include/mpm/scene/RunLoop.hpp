#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "mpm/io/FieldOutput.hpp"
#include "mpm/io/Summary.hpp"
#include "mpm/run/Clock.hpp"
#include "mpm/run/Progress.hpp"
#include "mpm/run/RunOptions.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::scene {

/// A part of a run with its own end. All functions are called on all ranks.
struct Stage {
  std::string name;
  /// The stage is over at 1; also drives the progress line.
  std::function<double()> share_done;
  /// Called with the length of the step to come, s.
  std::function<void(double dt)> before_step;
  std::function<void()> after_step;
  /// Short text for the progress line, from values at hand (no communication).
  std::function<std::string()> status;
  /// Time at which the stage ends, if known: the last step is cut to meet it.
  double end_time = 0.0;                                     ///< s within the stage; 0 if unknown
  double longest_step = std::numeric_limits<double>::max();  ///< s
  /// Limits and outputs of the run count from the beginning of the first such stage on.
  bool is_main = true;
};

/// Drives the steps of a simulation through stages; owns outputs, progress and timing.
template <int dim>
class RunLoop {
 public:
  /// Collective.
  RunLoop(const run::RunOptions& options, solver::Simulation<dim>& simulation);

  const run::Clock& clock() const { return m_clock; }

  /// From here on time counts from zero, and displacements and strains do. Local.
  void begin_anew() {
    m_simulation.start_from_rest();
    m_clock.time = 0.0;
  }

  /// Returns false if the run as a whole is over (-end_time, -max_steps). Collective.
  bool run(const Stage& stage);

  /// Writes particles and grid now unless this step has been written; `numbers` go with it as
  /// attributes. Collective.
  void write_fields(std::vector<std::pair<std::string, double>> numbers = {});
  /// Numbers to go with outputs that the loop itself decides on.
  void set_output_numbers(std::function<std::vector<std::pair<std::string, double>>()> numbers) {
    m_output_numbers = std::move(numbers);
  }

  /// Ranks, cells, particles, steps, speed and memory; mass and momentum at the end. Collective.
  void summarise(io::Summary& summary) const;

 private:
  bool is_over() const;
  double longest_step(const Stage& stage) const;
  void write_due_fields();

  const run::RunOptions& m_options;
  solver::Simulation<dim>& m_simulation;
  io::FieldOutput<dim> m_output;
  run::Progress m_progress;
  run::Clock m_clock;
  long long m_last_written = -1;  ///< step
  std::function<std::vector<std::pair<std::string, double>>()> m_output_numbers;
  std::vector<double> m_times_left;
  double m_seconds_in_steps = 0.0;
  double m_initial_mass;
};

extern template class RunLoop<1>;
extern template class RunLoop<2>;
extern template class RunLoop<3>;

}  // namespace mpm::scene
