#include "mpm/run/RunOptions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "mpm/solver/StableCourant.hpp"

namespace mpm::run {

namespace {

constexpr double share_of_limit = 0.5;

std::string default_courant(double largest) {
  const std::string half = "half the limit of basis, update and transfer";
  return largest < 2.0 ? fmt::format("{}, at most {}", half, largest) : half;
}

}  // namespace

double RunOptions::stable_courant() const {
  return solver::stable_courant({basis, ends, scheme, transfer});
}

double RunOptions::courant() const {
  return given_courant.value_or(std::min(largest_courant, share_of_limit * stable_courant()));
}

void RunOptions::declare(options::OptionSet& options) {
  options.section("Run");
  options.path("output_dir", output_dir,
               {"", "directory of all results, made if missing", "chosen"});
  declare_basis(options);
  declare_step(options);
  declare_regularisation(options);
  declare_balance(options);
  declare_outputs(options);
  if (is_one_run) checkpoint.declare(options);
}

void RunOptions::declare_basis(options::OptionSet& options) {
  options.choice(
      "basis", basis, basis::kinds(),
      {"",
       "shape functions: linear (standard MPM), uGIMP, dual domain (DDMP), or B-splines; gimp and "
       "ddmp always mirror at walls",
       "paper, section 2.2"});
  options.choice(
      "basis_boundary", ends,
      {{"mirror", basis::EndTreatment::mirror}, {"open_knot", basis::EndTreatment::open_knot}},
      {"",
       "splines at the ends of the grid: reflected, or end knots repeated as in the "
       "paper",
       "docs/model.md"});
}

void RunOptions::declare_step(options::OptionSet& options) {
  options.choice(
      "update", scheme,
      {{"musl", solver::Scheme::musl}, {"usl", solver::Scheme::usl}, {"usf", solver::Scheme::usf}},
      {"",
       "when stress is renewed: last, from velocities mapped anew (musl, the paper) or from those "
       "of the momentum update (usl), or first (usf)",
       "Eqs. 1-9; docs/model.md"});
  options.choice(
      "transfer", transfer,
      {{"flip", solver::Transfer::flip},
       {"pic", solver::Transfer::pic},
       {"apic", solver::Transfer::apic}},
      {"",
       "how grid motion reaches the particles: by its change; by itself, which damps the more the "
       "smaller the step; or by itself with particles that carry its gradient too",
       "Eq. 7; docs/model.md"});
  options.optional_real(
      "flip_time", flip_time, options::not_negative(), default_flip_time,
      {"s",
       "time in which particle velocities turn into the grid's: keeps exp(-dt/tau) per step, 0 "
       "is pure FLIP; for flip only",
       "docs/model.md"});
  options.effective([this] { return transfer == solver::Transfer::flip; },
                    "only with -transfer flip");
  options.flag("average_volume", averages_volume,
               {"",
                "particles take the mean volume change of their surroundings, against scatter of "
                "pressures; not while soil comes to rest under local damping",
                "docs/model.md"});
  options.real("average_volume_share", averaged_volume_share,
               {.minimum = 0.0, .maximum = 1.0, .open_minimum = true},
               {"1",
                "share of the mean in the volume change that particles take; what is left of their "
                "own holds pressures that alternate from cell to cell",
                "docs/model.md"});
  options.rule([this, &options] {
    if (averages_volume || !options.is_changed("average_volume_share")) return;
    throw options::bad_input({options.given("average_volume_share"), "has no effect here",
                              "only with averaged volumes", "give -average_volume, too"});
  });
  options.optional_real(
      "courant", given_courant, {.minimum = 0.0, .maximum = 2.0, .open_minimum = true},
      default_courant(largest_courant),
      {"1", "time step as a share of h/(c + |v|), h the smallest knot span near a particle",
       "docs/methods.md; the paper uses 0.3"});
  options.caution([this] {
    if (courant() <= stable_courant()) return std::string();
    return fmt::format(
        "-courant {} is above {}, the limit of this basis, update and transfer in the worst "
        "places of particles: the run may blow up",
        courant(), stable_courant());
  });
  options.integer("particles_per_cell_direction", particles_per_cell_direction, {1, 16},
                  {"1", "particles per cell and direction", "paper, section 3.3"});
}

void RunOptions::declare_regularisation(options::OptionSet& options) {
  options.real(
      "regularisation_length", regularisation_length, options::not_negative(),
      {"m",
       "length over which the increments of what softens a law (void ratio, eps_q of sand) are "
       "averaged, whatever the cells; at least two of the smallest cells, 0 not at all",
       "docs/model.md"});
  options.integer("regularisation_every", regularisation_every, {1, 1'000'000},
                  {"steps", "steps between two averagings", "docs/model.md"});
  options.rule([this, &options] {
    if (regularisation_length > 0.0 || !options.is_changed("regularisation_every")) return;
    throw options::bad_input({options.given("regularisation_every"), "has no effect here",
                              "only with a length", "give -regularisation_length, too"});
  });
}

void RunOptions::declare_balance(options::OptionSet& options) {
  options.choice(
      "load_balance", balance.method,
      {{"ranges", solver::LoadBalance::ranges}, {"metis", solver::LoadBalance::metis}},
      {"",
       "how cells are shared out over the ranks: ranges in every direction, or blocks of "
       "cells in parts by METIS; the answer is the same but for rounding",
       "docs/performance.md"});
  options.real("rebalance_above", balance.rebalance_above, {.minimum = 0.0, .maximum = 1e6},
               {"1",
                "cells are shared out anew where the largest number of particles of a rank is more "
                "than this many times the mean; 0 never",
                "chosen"});
}

void RunOptions::declare_outputs(options::OptionSet& options) {
  options.integer(
      "particle_output_every", particle_output_every, {0, 1'000'000'000},
      {"steps", "steps between outputs of particles and grid; 0 leaves it to the scene", "chosen"});
  options.real_list("particle_output_times", particle_output_times, options::not_negative(),
                    {"s", "times of outputs of particles and grid, in addition", "chosen"});
  options.effective(
      [this] {
        return !end_time || std::ranges::all_of(particle_output_times,
                                                [this](double t) { return t <= *end_time; });
      },
      "not all of it is before -end_time");
  options.integer(
      "history_every", history_every, {0, 1'000'000'000},
      {"steps", "steps between rows of history.csv; 0 leaves it to the scene", "chosen"});
  options.optional_real(
      "end_time", end_time, options::positive(), "the scene's own end",
      {"s", "the run ends here at the latest, on the clock of the main stage", "chosen"});
  options.integer(
      "max_steps", max_steps, {0, 1'000'000'000'000},
      {"steps", "the run ends after so many steps at the latest; 0 is no limit", "chosen"});
  options.text("counted_stage", counted_stage,
               {"",
                "stage from whose beginning on -end_time, -max_steps, -particle_output_times and "
                "the *_every count; empty is the scene's main one, not the settling before it",
                "chosen"});
  options.choice(
      "progress", progress,
      {{"auto", ProgressDisplay::automatic},
       {"on", ProgressDisplay::on},
       {"off", ProgressDisplay::off}},
      {"", "progress on the terminal: a line that renews itself, or plain lines in a log",
       "chosen"});
}

}  // namespace mpm::run
