#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "mpm/run/Observer.hpp"

namespace mpm::run {

/// When a stage is over. All calls are made on all ranks.
template <int dim>
class Ending {
 public:
  virtual ~Ending() = default;
  virtual void begin(const Moment<dim>&) {}
  virtual void after_step(const Moment<dim>&) {}
  /// The stage is over at 1; also drives the progress line.
  virtual double share_done(const Moment<dim>& moment) const = 0;
  /// Time until the end, s, if it is known: the last step is cut to meet it.
  virtual double time_left(const Clock&) const { return std::numeric_limits<double>::max(); }
  virtual std::string status() const { return ""; }
  virtual void persist(Archive&) {}
};

/// A part of a run with its own end.
template <int dim>
struct Stage {
  std::string name;
  std::shared_ptr<Ending<dim>> ending;
  /// Limits, outputs and observers of the run begin with the first such stage.
  bool is_main = true;
  double damping = 0.0;         ///< local: f -= damping |f| sign(v) per component
  bool holds_bodies = false;    ///< rigid bodies stand still
  bool begins_at_rest = false;  ///< velocities, displacements and strains are set to zero first
  bool begins_anew = false;     ///< the same, and time counts from zero
  double longest_step = std::numeric_limits<double>::max();  ///< s
  std::optional<Vector<dim>> gravity = std::nullopt;         ///< m/s^2, from here on
  /// What has to hold when it is over, and what is measured then. Collective.
  std::function<void(const Moment<dim>&)> at_end = {};
};

}  // namespace mpm::run
