#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mpm/options/OptionSet.hpp"
#include "mpm/run/CheckpointOptions.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::run {

enum class ProgressDisplay { automatic, on, off };

/// Options that every scene on a grid has. A scene sets its own defaults before declaring them.
struct RunOptions {
  std::string output_dir;
  basis::Kind basis = basis::Kind::cubic;
  basis::EndTreatment ends = basis::EndTreatment::mirror;
  solver::Scheme scheme = solver::Scheme::musl;
  solver::Transfer transfer = solver::Transfer::flip;
  std::optional<double> flip_time;  ///< s; 0 is pure FLIP
  std::string default_flip_time = "pure FLIP";
  bool averages_volume = false;
  double averaged_volume_share = 0.9;
  double regularisation_length = 0.0;  ///< m
  std::int64_t regularisation_every = 20;
  /// What a scene takes at the most unless told otherwise, where its answer needs small steps.
  double largest_courant = 2.0;
  std::optional<double> given_courant;
  std::int64_t particles_per_cell_direction = 2;
  solver::BalanceOptions balance;
  std::int64_t particle_output_every = 0;
  std::vector<double> particle_output_times;
  std::int64_t history_every = 0;
  std::optional<double> end_time;
  std::int64_t max_steps = 0;
  /// Where the limits and outputs above count from the beginning of; the main one if empty.
  std::string counted_stage;
  ProgressDisplay progress = ProgressDisplay::automatic;
  /// Of one run that can be interrupted; a scene of many, or of none, has no such options.
  bool is_one_run = true;
  CheckpointOptions checkpoint;

  void declare(options::OptionSet& options);

  /// Time step as a share of h/(c + |v|): as given, or half the limit of the method.
  double courant() const;
  /// Whether a step has a row of history.csv, in scenes whose own choice is every step.
  bool row_is_due(std::int64_t step) const {
    return step % std::max<std::int64_t>(1, history_every) == 0;
  }
  /// The limit of the method, see solver/StableCourant.hpp.
  double stable_courant() const;

  template <int dim>
  void apply_to(solver::SimulationSetup<dim>& setup) const {
    setup.basis = basis;
    setup.ends = ends;
    setup.particles_per_cell = static_cast<int>(particles_per_cell_direction);
    setup.scheme = scheme;
    setup.courant = courant();
    setup.averaged_volume_share = averages_volume ? averaged_volume_share : 0.0;
    setup.regularisation = {regularisation_length, static_cast<int>(regularisation_every)};
    setup.transfer = transfer;
    setup.balance = balance;
    if (flip_time.value_or(0.0) > 0.0) setup.flip_time = *flip_time;
    setup.filling.per_direction = [n = setup.particles_per_cell](const Vector<dim>&) { return n; };
  }

 private:
  void declare_basis(options::OptionSet& options);
  void declare_step(options::OptionSet& options);
  void declare_regularisation(options::OptionSet& options);
  void declare_balance(options::OptionSet& options);
  void declare_outputs(options::OptionSet& options);
};

}  // namespace mpm::run
