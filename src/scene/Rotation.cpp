#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

/// Gives every node the velocity of a rigid turn, omega x (x_I - centre).
class RigidTurn : public grid::NodalCondition<2> {
 public:
  RigidTurn(double omega, Vector<2> centre) : m_omega(omega), m_centre(centre) {}

  void correct(const grid::Grid<2>& grid, const grid::NodalMotion<2>& motion) override {
    grid.for_each_owned_node([&](int I, const auto& node) {
      const Vector<2> x = grid.position(node);
      motion.momentum[0][I] = -motion.mass[I] * m_omega * (x[1] - m_centre[1]);
      motion.momentum[1][I] = motion.mass[I] * m_omega * (x[0] - m_centre[0]);
      if (motion.is_first_mapping()) motion.force[0][I] = motion.force[1][I] = 0.0;
    });
  }

 private:
  double m_omega;
  Vector<2> m_centre;
};

/// A disc under uniaxial stress turns rigidly once: its stress must turn with it, unchanged in
/// size, and its volume must stay.
class Rotation : public Scene {
 public:
  Rotation() { m_run.output_dir = "out/rotation"; }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Rotation");
    options.integer("cells", m_cells, {4, 10'000}, {"1", "cells per diameter", "chosen"});
    options.integer("increments", m_steps, {4, 10'000'000},
                    {"1", "steps of a full turn", "chosen"});
    options.real("amplitude", m_stress, options::positive(),
                 {"Pa", "uniaxial stress at the start", "chosen"});
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    solver::Simulation<2> simulation(setup());
    simulation.add_condition(std::make_shared<RigidTurn>(omega, Vector<2>{0.0, 0.0}));
    const double volume = stress_particles(simulation);
    RunLoop<2> loop(m_run, simulation);
    const double dt = 2 * std::numbers::pi / omega / static_cast<double>(m_steps);
    const auto steps = static_cast<double>(m_steps);
    loop.run({.name = "turn",
              .share_done = [&] { return static_cast<double>(simulation.state().step) / steps; },
              .before_step = [&] { simulation.limit_next_step(dt); }});
    loop.write_fields();
    loop.summarise(summary);
    report_errors(simulation, volume, summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("stress norm {:.2g}, volume {:.2g}, angle {:.2g} rad off",
                       summary.number("error_stress_norm"), summary.number("error_volume_ratio"),
                       summary.number("error_angle_rad"));
  }

 private:
  static constexpr double omega = 2.3;   // rad/s
  static constexpr double radius = 0.8;  // m

  solver::SimulationSetup<2> setup() const {
    const auto line =
        basis::KnotLines::uniform(-2.0 * radius, 2.0 * radius, 2 * static_cast<int>(m_cells));
    solver::SimulationSetup<2> setup{.lines = {line, line}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    setup.materials = {std::make_shared<material::LinearElastic>(
        material::LinearElasticParameters{.youngs_modulus = 1.0, .density = 1300.0})};
    setup.filling = {
        [](const Vector<2>& x) {
          return std::hypot(x[0], x[1]) < radius ? std::optional(0) : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  double stress_particles(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    double volume = 0.0;
    for (int p = 0; p < view.count; ++p) {
      view.stress[0][p] = m_stress;
      volume += view.volume[p];
    }
    return petsc::sum(volume);
  }

  void report_errors(const solver::Simulation<2>& simulation, double initial_volume,
                     io::Summary& summary) const {
    const auto view = simulation.particles().view();
    double norm_error = 0.0, angle_error = 0.0, volume = 0.0;
    for (int p = 0; p < view.count; ++p) {
      const double xx = view.stress[0][p], yy = view.stress[1][p], xy = view.stress[3][p];
      norm_error = std::max(norm_error,
                            std::abs(std::sqrt(xx * xx + yy * yy + 2 * xy * xy) / m_stress - 1.0));
      angle_error = std::max(angle_error, std::abs(0.5 * std::atan2(2 * xy, xx - yy)));
      volume += view.volume[p];
    }
    summary.set("error_stress_norm", petsc::maximum(norm_error));
    summary.set("error_volume_ratio", std::abs(petsc::sum(volume) / initial_volume - 1.0));
    summary.set("error_angle_rad", petsc::maximum(angle_error));
  }

  RunOptions m_run;
  std::int64_t m_cells = 8;
  std::int64_t m_steps = 1000;
  double m_stress = 3e4;
};

}  // namespace

std::unique_ptr<Scene> make_rotation() {
  return std::make_unique<Rotation>();
}

}  // namespace mpm::scene
