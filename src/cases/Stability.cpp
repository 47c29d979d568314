#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/cases/Case.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/RunOptions.hpp"
#include "mpm/solver/OneStepMatrix.hpp"

namespace mpm::cases {
namespace {

constexpr double h = 0.37;          // m, any
constexpr double search_end = 3.0;  // Courant number
constexpr double search_accuracy = 1e-3;
constexpr double allowed_growth = 1e-6;  // of a step
const material::LinearElasticParameters elastic{
    .youngs_modulus = 2.7e5, .poisson_ratio = 0.3, .density = 1300.0};

double wave_modulus() {
  const double nu = elastic.poisson_ratio;
  return elastic.youngs_modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu));
}

/// Largest Courant number below `end` up to which all are stable, found in strides.
double stable_limit(const std::array<solver::DenseMatrix, 3>& T, double stride, double end) {
  const auto is_stable = [&](double courant) {
    return solver::spectral_radius(T, courant) <= 1.0 + allowed_growth;
  };
  double stable = 0.0, unstable = stride;
  while (unstable < end && is_stable(unstable)) stable = unstable, unstable += stride;
  if (unstable >= end) {
    if (is_stable(end)) return end;
    unstable = end;
  }
  while (unstable - stable > search_accuracy) {
    const double middle = 0.5 * (stable + unstable);
    (is_stable(middle) ? stable : unstable) = middle;
  }
  return stable;
}

/// The largest Courant number at which the matrix of one step, a linear map of particle velocities
/// and stresses, has no eigenvalue beyond 1 + 1e-6: in a box between rollers, which has no boundary
/// but mirrors, between fixed walls, in a box filled up to the grid's free ends, and in a free body
/// whose outermost particle stands anywhere in its cell.
class Stability : public Case {
 public:
  Stability() {
    m_run.output_dir = "out/stability";
    m_run.is_one_run = false;
  }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Stability");
    options.integer("dimension", m_dimension, {1, 2}, {"1", "of the body", "chosen"});
    options.integer("cells", m_cells, {2, 50}, {"1", "cells of the body per direction", "chosen"});
    options.real("stride", m_stride, {.minimum = 0.001, .maximum = 1.0},
                 {"1", "between the Courant numbers that are tried", "chosen"});
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void prepare() override {
    if (petsc::world_size() > 1)
      throw BadInput(fmt::format("{} ranks: -scene stability runs on one", petsc::world_size()));
    if (m_run.flip_time.value_or(0.0) > 0.0)
      throw BadInput(
          "-flip_time: -scene stability knows steps that are quadratic in dt only; leave it out");
  }

  void run(io::Summary& summary) override {
    summary.set("ranks", 1);
    m_dimension == 1 ? find_limits<1>(summary) : find_limits<2>(summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format(
        "stable up to a Courant number of {:.3g} inside, {:.3g} at fixed walls, {:.3g} at a free "
        "surface",
        summary.number("limit_interior"), summary.number("limit_fixed_wall"),
        summary.number("limit_free_surface"));
  }

 private:
  template <int dim>
  void find_limits(io::Summary& summary) const {
    summary.set("search_end", search_end);
    summary.set("stable_courant", m_run.stable_courant());
    summary.set("limit_interior", limit_in_box<dim>(grid::Wall::roller));
    summary.set("limit_fixed_wall", limit_in_box<dim>(grid::Wall::fixed));
    summary.set("limit_filled_to_free_end", limit_in_box<dim>(grid::Wall::free));
    double lowest = search_end, two_over_omega = std::numeric_limits<double>::max();
    Vector<dim> worst{};
    for (const Vector<dim>& place : places<dim>()) {
      solver::Simulation<dim> simulation(free_body_setup<dim>());
      put<dim>(simulation, place);
      const auto T = solver::one_step_matrices(simulation, scales());
      const double limit = stable_limit(T, m_stride, lowest);
      if (limit < lowest) worst = place;
      lowest = std::min(lowest, limit);
      two_over_omega = std::min(two_over_omega, 2.0 / solver::largest_frequency(T[2]));
    }
    summary.set("limit_free_surface", lowest);
    summary.set("worst_place", std::vector<double>(worst.begin(), worst.end()));
    summary.set("two_over_omega_free_surface", two_over_omega);
  }

  /// Where the outermost particle stands in its cell, as a share of it, per direction.
  template <int dim>
  static std::vector<Vector<dim>> places() {
    std::vector<Vector<dim>> places;
    if constexpr (dim == 1) {
      places = {{1e-3}, {0.01}};
      for (int k = 1; k < 20; ++k) places.push_back({0.05 * k});
      places.insert(places.end(), {{0.99}, {0.999}});
    } else {
      const std::vector<double> shares{0.01, 0.25, 0.5, 0.75, 0.99};
      for (std::size_t i = 0; i < shares.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j) places.push_back({shares[i], shares[j]});
    }
    return places;
  }

  double spacing() const { return h / static_cast<double>(m_run.particles_per_cell_direction); }

  /// A body in the middle of the grid.
  template <int dim>
  solver::SimulationSetup<dim> free_body_setup() const {
    constexpr int margin = 3;
    auto setup = make_setup<dim>(static_cast<int>(m_cells) + 2 * margin + 1, grid::Wall::free);
    const double first = margin * h, last = first + static_cast<double>(m_cells) * h;
    setup.filling.material_at = [=](const Vector<dim>& x) {
      const bool inside =
          std::all_of(x.begin(), x.end(), [=](double c) { return c > first && c < last; });
      return inside ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  /// Moves the body until its outermost particle stands at `place`.
  template <int dim>
  void put(solver::Simulation<dim>& simulation, const Vector<dim>& place) const {
    {
      const auto view = simulation.particles().view();
      for (int d = 0; d < dim; ++d)
        for (int p = 0; p < view.count; ++p) view.position[d][p] += place[d] * h + 0.5 * spacing();
    }
    simulation.particles().migrate();
  }

  template <int dim>
  double limit_in_box(grid::Wall wall) const {
    solver::Simulation<dim> simulation(make_setup<dim>(static_cast<int>(m_cells), wall));
    return stable_limit(solver::one_step_matrices(simulation, scales()), m_stride, search_end);
  }

  static solver::StateScales scales() {
    return {std::sqrt(wave_modulus() / elastic.density), wave_modulus(), h};
  }

  template <int dim>
  solver::SimulationSetup<dim> make_setup(int cells, grid::Wall wall) const {
    const auto line = basis::KnotLines::uniform(0.0, cells * h, cells);
    std::array<basis::KnotLines, dim> lines = [&] {
      if constexpr (dim == 1) return std::array{line};
      if constexpr (dim == 2) return std::array{line, line};
    }();
    solver::SimulationSetup<dim> setup{.lines = lines};
    m_run.apply_to(setup);
    setup.courant = 1e6;  // dt is given
    for (auto& direction : setup.walls) direction = {wall, wall};
    setup.materials = {std::make_shared<material::LinearElastic>(elastic)};
    setup.filling = {
        [](const auto&) { return 0; },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  run::RunOptions m_run;
  std::int64_t m_dimension = 1;
  std::int64_t m_cells = 6;
  double m_stride = 0.05;
};

}  // namespace

std::unique_ptr<Case> make_stability() {
  return std::make_unique<Stability>();
}

}  // namespace mpm::cases
