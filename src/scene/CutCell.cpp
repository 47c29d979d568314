#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
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

/// An elastic body whose surfaces stand at one place in their cells, shaken a little.
template <int dim>
class CutCellRun {
 public:
  CutCellRun(const CutCellOptions& options, double offset);

  void run();
  void write_row(io::CsvFile& history) const;
  void write_fields() { m_loop.write_fields(); }
  void summarise(io::Summary& summary) const { m_loop.summarise(summary); }
  double growth() const;
  bool is_stable() const;

 private:
  static solver::SimulationSetup<dim> setup(const CutCellOptions& options);
  void shift();
  void shake();
  double energy() const;

  const CutCellOptions& m_options;
  double m_offset;
  solver::Simulation<dim> m_simulation;
  RunLoop<dim> m_loop;
  double m_initial_energy = 0.0;  ///< J
  double m_energy = 1.0;          ///< of the last step, over that at the start
  /// Largest energy of each window, over that at the start.
  std::vector<double> m_largest = std::vector<double>(windows, 0.0);
};

template <int dim>
CutCellRun<dim>::CutCellRun(const CutCellOptions& options, double offset)
    : m_options(options),
      m_offset(offset),
      m_simulation(setup(options)),
      m_loop(options.run, m_simulation) {
  shift();
  shake();
  m_initial_energy = energy();
}

template <int dim>
solver::SimulationSetup<dim> CutCellRun<dim>::setup(const CutCellOptions& options) {
  const auto n = static_cast<int>(options.cells);
  const auto line = basis::KnotLines::uniform(-margin * cell, (n + margin) * cell, n + 2 * margin);
  solver::SimulationSetup<dim> setup{.lines = repeated<dim>(line)};
  options.run.apply_to(setup);
  for (auto& direction : setup.walls) direction = {grid::Wall::free, grid::Wall::free};
  setup.materials = {options.material.create()};
  setup.filling = {[side = n * cell](const Vector<dim>& x) {
                     const bool inside = std::all_of(x.begin(), x.end(),
                                                     [&](double c) { return c > 0.0 && c < side; });
                     return inside ? std::optional(0) : std::nullopt;
                   },
                   [&options](const auto&) {
                     return static_cast<int>(options.run.particles_per_cell_direction);
                   }};
  return setup;
}

/// Seeded on cells, the particles keep their even spacing.
template <int dim>
void CutCellRun<dim>::shift() {
  {
    const auto view = m_simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      for (std::size_t d = 0; d < dim; ++d) view.position[d][p] += m_offset * cell;
  }
  m_simulation.particles().migrate();
}

/// Random velocities without a mean, all particles being equally heavy.
template <int dim>
void CutCellRun<dim>::shake() {
  const auto& elastic = m_options.material.parameters();
  const double largest = m_options.amplitude * std::sqrt(elastic.youngs_modulus / elastic.density);
  {
    const auto view = m_simulation.particles().view();
    for (int p = 0; p < view.count; ++p)
      for (std::size_t d = 0; d < dim; ++d)
        view.velocity[d][p] = largest * scatter(static_cast<std::uint64_t>(view.id[p]) * dim + d);
  }
  const Vector<dim> momentum = m_simulation.momentum();
  const double mass = m_simulation.total_mass();
  const auto view = m_simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    for (std::size_t d = 0; d < dim; ++d) view.velocity[d][p] -= momentum[d] / mass;
}

/// Kinetic, and elastic from the stress: V (s:s (1 + nu) - nu tr(s)^2)/(2 E). J per unit of the
/// dimensions left out.
template <int dim>
double CutCellRun<dim>::energy() const {
  const auto& [E, nu, density] = m_options.material.parameters();
  const auto view = m_simulation.particles().view();
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
  return petsc::sum(sum);
}

template <int dim>
void CutCellRun<dim>::run() {
  const auto steps = static_cast<double>(m_options.steps);
  const run::Clock& clock = m_loop.clock();
  const auto after_step = [&] {
    m_energy = energy() / m_initial_energy;
    if (std::isnan(m_energy)) m_energy = blown_up;
    const auto window = static_cast<std::size_t>((clock.step - 1) * windows / m_options.steps);
    m_largest[window] = std::max(m_largest[window], m_energy);
  };
  m_loop.run(
      {.name = fmt::format("offset {:.3g}", m_offset),
       .share_done =
           [&] { return m_energy < blown_up ? static_cast<double>(clock.step) / steps : 1.0; },
       .after_step = after_step});
}

template <int dim>
void CutCellRun<dim>::write_row(io::CsvFile& history) const {
  history.row({m_offset, growth(), m_energy, is_stable() ? 1.0 : 0.0,
               static_cast<double>(m_loop.clock().step)});
}

/// Largest energy over that at the start.
template <int dim>
double CutCellRun<dim>::growth() const {
  return *std::max_element(m_largest.begin(), m_largest.end());
}

/// Energy goes to and fro between motion and strain; what counts is whether it rises for good. A
/// run that was cut short has shown nothing.
template <int dim>
bool CutCellRun<dim>::is_stable() const {
  const double earlier = *std::max_element(m_largest.begin(), m_largest.end() - windows / 2);
  const bool is_complete = m_loop.clock().step >= m_options.steps;
  return is_complete && growth() < blown_up && m_largest.back() <= unsteady * earlier;
}

/// A free elastic body is shaken at random while its surfaces stand at a given place in their
/// cells: with lightly filled cells the nodes beyond them have hardly any mass. Both ends of the
/// body are cut, so that places from 0 to 1 show every filling twice. Exact: the energy stays what
/// it was at the start, or falls where a method dissipates.
class CutCell : public Scene {
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
      CutCellRun<dim> run(m_options, offset);
      run.run();
      run.write_row(history);
      if (run.is_stable()) ++stable;
      if (run.growth() > worst) {
        worst = run.growth();
        worst_offset = offset;
      }
      if (offset != places.back()) continue;
      run.write_fields();
      run.summarise(summary);
    }
    const auto all = static_cast<std::int64_t>(places.size());
    summary.set("offsets", all);
    summary.set("stable_offsets", stable);
    summary.set("stable", stable == all ? 1 : 0);
    summary.set("energy_growth", worst);
    summary.set("worst_offset", worst_offset);
  }

  CutCellOptions m_options;
};

}  // namespace

std::unique_ptr<Scene> make_cut_cell() {
  return std::make_unique<CutCell>();
}

}  // namespace mpm::scene
