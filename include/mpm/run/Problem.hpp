#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mpm/contact/RigidBody.hpp"
#include "mpm/run/Cadence.hpp"
#include "mpm/run/Stage.hpp"

namespace mpm::run {

/// What is to be computed, as data. All functions are the same on all ranks.
template <int dim>
struct Problem {
  /// Grid, walls, laws, what fills the grid, gravity and method.
  solver::SimulationSetup<dim> setup;
  /// Moves seeded particles or gives them velocity and state; they migrate afterwards. Collective.
  std::function<void(solver::Simulation<dim>&)> arrange = {};
  /// At a position, tension positive, Pa; the laws take the state that belongs to it.
  std::function<SymmetricTensor(const Vector<dim>&)> initial_stress = {};
  /// What to say where a law admits no such stress: option, value and remedy.
  std::string initial_stress_remedy = {};
  /// At an undeformed position and a time, in place of gravity, m/s^2.
  std::function<Vector<dim>(const Vector<dim>&, double)> body_force = {};
  std::vector<particles::SurfacePiece<dim>> loaded_surface = {};
  /// The pressure on all of it at a time, Pa, in place of what its pieces have.
  std::function<double(double)> surface_pressure = {};
  /// Made once the grid is there, in the order in which they act.
  using MakeConstraint =
      std::function<std::shared_ptr<grid::Constraint<dim>>(const solver::Simulation<dim>&)>;
  std::vector<MakeConstraint> constraints = {};
  /// Moved and metered by the run.
  std::vector<std::shared_ptr<contact::RigidBody<dim>>> bodies = {};
  std::vector<Stage<dim>> stages = {};
  std::vector<std::shared_ptr<Observer<dim>>> observers = {};

  /// When particles and grid are written besides the end and what the options ask for.
  std::optional<Cadence<dim>> field_cadence = std::nullopt;
  bool writes_fields_at_start = false;  ///< of the main stage
  std::function<Numbers(const Moment<dim>&)> field_numbers = {};
};

}  // namespace mpm::run
