#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mpm/core/Archive.hpp"
#include "mpm/run/Clock.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::run {

/// A run as its parts see it between two steps.
template <int dim>
struct Moment {
  solver::Simulation<dim>& simulation;
  const Clock& clock;
};

/// Numbers that go with an output of fields as attributes.
using Numbers = std::vector<std::pair<std::string, double>>;

/// Looks at a run between its steps, and keeps what it saw. Whatever it knows from one step to the
/// next it can save. All calls are made on all ranks.
template <int dim>
class Observer {
 public:
  Observer() = default;
  virtual ~Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;

  /// Before the first step of the run, when the particles have their initial state.
  virtual void begin(const Moment<dim>&) {}
  /// Before the first step of every stage from the main one on.
  virtual void begin_stage(const Moment<dim>&) {}
  /// After every step from the main stage on.
  virtual void after_step(const Moment<dim>&) {}
  /// Before the first step of a run that goes on from a checkpoint, when persist() has put back
  /// what there was.
  virtual void go_on(const Moment<dim>&) {}
  /// When the run is over.
  virtual void end(const Moment<dim>&) {}
  /// Short text for the progress line, from values at hand; no communication.
  virtual std::string status() const { return ""; }
  virtual void persist(Archive&) {}
};

}  // namespace mpm::run
