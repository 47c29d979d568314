#pragma once

#include <optional>
#include <string>

#include "mpm/cases/Case.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/run/Run.hpp"

namespace mpm::cases {

/// A case that is one run of a problem on a grid: what it builds, and what it makes of the run.
template <int dim>
class GridCase : public Case {
 public:
  const std::string& output_directory() const final { return run_options().output_dir; }
  void prepare() final { m_run.emplace(run_options(), problem()); }

  bool goes_on_in_place() const final { return m_run->goes_on_in_place(); }

  void run(io::Summary& summary) final {
    try {
      m_run->go();
    } catch (const NumericalFailure& failure) {
      throw explained(failure);
    }
    m_run->summarise(summary);
    evaluate(*m_run, summary);
  }

 protected:
  virtual const run::RunOptions& run_options() const { return m_options; }
  /// What is to be computed, from the options. Throws BadInput where they make no sense together.
  /// Collective.
  virtual run::Problem<dim> problem() = 0;
  /// Puts the answers of a finished run into the summary. Collective.
  virtual void evaluate(run::Run<dim>& run, io::Summary& summary) = 0;
  /// A failure of the run with what the case knows about it.
  virtual NumericalFailure explained(const NumericalFailure& failure) const { return failure; }

  /// Every step, or as -history_every says.
  run::Cadence<dim> every_step() const {
    return run::Cadence<dim>(1).or_every(run_options().history_every);
  }
  std::string path(const char* file) const { return run_options().output_dir + "/" + file; }

  run::RunOptions m_options;

 private:
  std::optional<run::Run<dim>> m_run;
};

}  // namespace mpm::cases
