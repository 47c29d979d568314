#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "mpm/cases/Case.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/Run.hpp"

namespace mpm::cases {
namespace {

constexpr double cell = 0.1;       // m
constexpr int margin = 5;          // empty cells on every side: more than a spline reaches
constexpr double blown_up = 1e4;   // times the energy at the start, which ends a run
constexpr int windows = 10;        // parts of a run whose largest energies are compared
constexpr double unsteady = 1.02;  // of the last window over an earlier one, above which it grows

struct CutCellOptions {
  run::RunOptions run;
  mutable material::LinearElasticFactory material;
  std::int64_t dimension = 1;
  std::int64_t cells = 6;
  std::int64_t steps = 10'000;
  std::int64_t offsets = 20;
  std::optional<double> offset;
  double amplitude = 1e-4;

  CutCellOptions() {
    run.output_dir = "out/cut_cell";
    run.is_one_run = false;
    material.parameters() = {.youngs_modulus = 2e6, .poisson_ratio = 0.3, .density = 1300.0};
  }

  void declare(options::OptionSet& options) {
    run.declare(options);
    options.section("Cut cell");
    options.integer("dimension", dimension, {1, 3}, {"1", "a bar, a square or a cube", "chosen"});
    options.integer("cells", cells, {2, 1000}, {"1", "cells along a side of the body", "chosen"});
    options.integer("increments", steps, {windows, 1'000'000'000},
                    {"steps", "of each run", "docs/model.md"});
    options.integer("offsets", offsets, {1, 100'000},
                    {"1", "places of the surface in a cell, evenly from 0", "chosen"});
    options.optional_real(
        "offset", offset, {.minimum = 0.0, .maximum = 1.0}, "all of -offsets",
        {"1", "one place only: distance from the cell's lower line, in cells", "chosen"});
    options.real("amplitude", amplitude, {.minimum = 0.0, .maximum = 0.1, .open_minimum = true},
                 {"1", "largest velocity at the start as a share of the wave speed", "chosen"});
    material.declare(options);
  }

  std::vector<double> places() const {
    if (offset) return {*offset};
    std::vector<double> all;
    for (std::int64_t k = 0; k < offsets; ++k)
      all.push_back(static_cast<double>(k) / static_cast<double>(offsets));
    return all;
  }
};

/// Evenly spread in [-1, 1), the same for a number whatever the rank.
double scatter(std::uint64_t number) {
  number += 0x9e3779b97f4a7c15ULL;
  number = (number ^ (number >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  number = (number ^ (number >> 27U)) * 0x94d049bb133111ebULL;
  number ^= number >> 31U;
  return static_cast<double>(number >> 11U) * 0x1p-52 - 1.0;
}

template <int dim>
std::array<basis::KnotLines, dim> repeated(const basis::KnotLines& line) {
  if constexpr (dim == 1) return {line};
  if constexpr (dim == 2) return {line, line};
  if constexpr (dim == 3) return {line, line, line};
}

/// Follows the energy of a shaken body.
template <int dim>
class ShakenEnergy : public run::Observer<dim> {
 public:
  ShakenEnergy(const material::LinearElasticParameters& elastic, std::int64_t steps)
      : m_elastic(elastic), m_steps(steps) {}

  void begin(const run::Moment<dim>& now) override { m_initial = energy(now.simulation); }
  void after_step(const run::Moment<dim>& now) override;
  void persist(Archive& archive) override {
    archive("initial", m_initial);
    archive("last", last);
    archive("largest", m_largest);
  }

  /// Largest energy over that at the start.
  double growth() const { return *std::max_element(m_largest.begin(), m_largest.end()); }
  /// Energy goes to and fro between motion and strain; what counts is whether it rises for good.
  bool has_stayed() const {
    const double earlier = *std::max_element(m_largest.begin(), m_largest.end() - windows / 2);
    return growth() < blown_up && m_largest.back() <= unsteady * earlier;
  }

  double last = 1.0;  ///< of the last step, over that at the start

 private:
  double energy(const solver::Simulation<dim>& simulation) const;

  material::LinearElasticParameters m_elastic;
  std::int64_t m_steps;
  double m_initial = 0.0;  ///< J
  /// Largest energy of each window, over that at the start.
  std::vector<double> m_largest = std::vector<double>(windows, 0.0);
};

/// Kinetic, and elastic from the stress: V (s:s (1 + nu) - nu tr(s)^2)/(2 E). J per unit of the
/// dimensions left out.
template <int dim>
double ShakenEnergy<dim>::energy(const solver::Simulation<dim>& simulation) const {
  const auto& [E, nu, density] = m_elastic;
  const auto view = simulation.particles().view();
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor stress;
    for (int k = 0; k < tensor_components<dim>; ++k)
      stress[k] = view.stress[static_cast<std::size_t>(k)][p];
    sum += view.volume[p] / (2.0 * E) *
           ((1.0 + nu) * contract(stress, stress) - nu * trace(stress) * trace(stress));
    for (std::size_t d = 0; d < dim; ++d)
      sum += 0.5 * view.mass[p] * view.velocity[d][p] * view.velocity[d][p];
  }
  return simulation.communicator().sum(sum);
}

template <int dim>
void ShakenEnergy<dim>::after_step(const run::Moment<dim>& now) {
  last = energy(now.simulation) / m_initial;
  if (std::isnan(last)) last = blown_up;
  const auto window = static_cast<std::size_t>((now.clock.step - 1) * windows / m_steps);
  m_largest[window] = std::max(m_largest[window], last);
}

template <int dim>
solver::SimulationSetup<dim> setup_of(const CutCellOptions& options) {
  const auto n = static_cast<int>(options.cells);
  const auto line = basis::KnotLines::uniform(-margin * cell, (n + margin) * cell, n + 2 * margin);
  solver::SimulationSetup<dim> setup{.lines = repeated<dim>(line)};
  options.run.apply_to(setup);
  for (auto& direction : setup.walls) direction = {grid::Wall::free, grid::Wall::free};
  setup.materials = {options.material.create()};
  setup.filling.material_at = [side = n * cell](const Vector<dim>& x) {
    const bool inside =
        std::all_of(x.begin(), x.end(), [&](double c) { return c > 0.0 && c < side; });
    return inside ? std::optional(0) : std::nullopt;
  };
  return setup;
}

/// Seeded on cells, the particles keep their even spacing.
template <int dim>
void shift(solver::Simulation<dim>& simulation, double offset) {
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    for (std::size_t d = 0; d < dim; ++d) view.position[d][p] += offset * cell;
}

/// Random velocities without a mean, all particles being equally heavy.
template <int dim>
void shake(solver::Simulation<dim>& simulation, const CutCellOptions& options) {
  const auto& elastic = options.material.parameters();
  const double largest = options.amplitude * std::sqrt(elastic.youngs_modulus / elastic.density);
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      for (std::size_t d = 0; d < dim; ++d)
        view.velocity[d][p] = largest * scatter(static_cast<std::uint64_t>(view.id[p]) * dim + d);
  }
  const Vector<dim> momentum = simulation.momentum();
  const double mass = simulation.total_mass();
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    for (std::size_t d = 0; d < dim; ++d) view.velocity[d][p] -= momentum[d] / mass;
}

/// An elastic body whose surfaces stand at one place in their cells, shaken a little.
template <int dim>
run::Problem<dim> problem_at(double offset, const CutCellOptions& options,
                             const std::shared_ptr<ShakenEnergy<dim>>& energy) {
  run::Problem<dim> problem{.setup = setup_of<dim>(options)};
  problem.arrange = [offset, &options](solver::Simulation<dim>& simulation) {
    shift<dim>(simulation, offset);
    simulation.particles().migrate();
    shake<dim>(simulation, options);
  };
  const auto steps = static_cast<double>(options.steps);
  problem.stages = {
      {.name = fmt::format("offset {:.3g}", offset),
       .ending = std::make_shared<run::When<dim>>([energy, steps](const run::Moment<dim>& now) {
         return energy->last < blown_up ? static_cast<double>(now.clock.step) / steps : 1.0;
       })}};
  problem.observers = {energy};
  return problem;
}

/// A free elastic body is shaken at random while its surfaces stand at a given place in their
/// cells: with lightly filled cells the nodes beyond them have hardly any mass. Both ends of the
/// body are cut, so that places from 0 to 1 show every filling twice. Exact: the energy stays what
/// it was at the start, or falls where a method dissipates.
class CutCell : public Case {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void run(io::Summary& summary) override {
    if (m_options.dimension == 1)
      sweep<1>(summary);
    else if (m_options.dimension == 2)
      sweep<2>(summary);
    else
      sweep<3>(summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format(
        "stable at {} of {} offsets; largest energy {:.4g} of the start's, at {:.3g}",
        summary.text("stable_offsets"), summary.text("offsets"), summary.number("energy_growth"),
        summary.number("worst_offset"));
  }

 private:
  template <int dim>
  void sweep(io::Summary& summary) {
    io::CsvFile history(m_options.run.output_dir + "/history.csv",
                        {"offset", "energy_growth", "energy_at_end_over_start", "stable", "steps"});
    const std::vector<double> places = m_options.places();
    double worst = 0.0, worst_offset = 0.0;
    std::int64_t stable = 0;
    for (const double offset : places) {
      const auto energy =
          std::make_shared<ShakenEnergy<dim>>(m_options.material.parameters(), m_options.steps);
      run::Run<dim> run(m_options.run, problem_at<dim>(offset, m_options, energy));
      run.go(offset == places.back() ? run::Fields::written : run::Fields::left_out);
      // A run that was cut short has shown nothing.
      const long long steps = run.clock().step;
      const bool is_stable = steps >= m_options.steps && energy->has_stayed();
      history.row({offset, energy->growth(), energy->last, is_stable ? 1.0 : 0.0,
                   static_cast<double>(steps)});
      if (is_stable) ++stable;
      if (energy->growth() > worst) {
        worst = energy->growth();
        worst_offset = offset;
      }
      if (offset == places.back()) run.summarise(summary);
    }
    report(static_cast<std::int64_t>(places.size()), stable, summary);
    summary.set("energy_growth", worst);
    summary.set("worst_offset", worst_offset);
  }

  static void report(std::int64_t all, std::int64_t stable, io::Summary& summary) {
    summary.set("offsets", all);
    summary.set("stable_offsets", stable);
    summary.set("stable", stable == all ? 1 : 0);
  }

  CutCellOptions m_options;
};

}  // namespace

std::unique_ptr<Case> make_cut_cell() {
  return std::make_unique<CutCell>();
}

}  // namespace mpm::cases
