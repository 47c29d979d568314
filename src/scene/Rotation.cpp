#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/scene/EnergyMeter.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

/// Gives every node the velocity of a rigid turn, omega x (x_I - centre).
class RigidTurn : public grid::Constraint<2> {
 public:
  RigidTurn(double omega, Vector<2> centre) : m_omega(omega), m_centre(centre) {}

  void constrain(const grid::Grid<2>& grid, grid::ConstrainedNodes<2>& nodes) override {
    grid.for_each_owned_node([&](int I, const auto& node) {
      const Vector<2> x = grid.position(node);
      nodes.set_velocity(I, 0, -m_omega * (x[1] - m_centre[1]));
      nodes.set_velocity(I, 1, m_omega * (x[0] - m_centre[0]));
    });
  }

 private:
  double m_omega;
  Vector<2> m_centre;
};

enum class Turn { prescribed, free };

/// A disc turns once. Prescribed: under uniaxial stress, by nodal velocities; its stress must turn
/// with it, unchanged in size, and its volume must stay. Free: a stiff disc spins under its own
/// inertia; exact for a rigid one are angle, angular momentum and energy. It starts unstressed and
/// so breathes a little, by the order of rho omega^2 R^2/E = 1e-4.
class Rotation : public Scene {
 public:
  Rotation() { m_run.output_dir = "out/rotation"; }

  void declare(options::OptionSet& options) override {
    m_run.declare(options);
    options.section("Rotation");
    options.integer("cells", m_cells, {4, 10'000}, {"1", "cells per diameter", "chosen"});
    options.choice("turn", m_turn, {{"prescribed", Turn::prescribed}, {"free", Turn::free}},
                   {"", "by given velocities of the nodes, or under its own inertia", "chosen"});
    options.integer("increments", m_steps, {4, 10'000'000},
                    {"1", "steps of a full prescribed turn", "chosen"});
    options.real("amplitude", m_stress, options::positive(),
                 {"Pa", "uniaxial stress at the start of a prescribed turn", "chosen"});
  }

  const std::string& output_directory() const override { return m_run.output_dir; }

  void run(io::Summary& summary) override {
    const auto law = std::make_shared<const material::LinearElastic>(elastic());
    solver::Simulation<2> simulation(setup(law));
    const double volume = total_volume(simulation);
    RunLoop<2> loop(m_run, simulation);
    if (m_turn == Turn::prescribed)
      turn_nodes(simulation, loop);
    else
      spin(simulation, loop, *law, summary);
    loop.write_fields();
    loop.summarise(summary);
    summary.set("error_volume_ratio", std::abs(total_volume(simulation) / volume - 1.0));
    if (m_turn == Turn::prescribed) report_stress(simulation, summary);
  }

  std::string answer(const io::Summary& summary) const override {
    if (m_turn == Turn::free)
      return fmt::format("angle {:.2g} rad, angular momentum {:.2g}, energy {:.2g} off",
                         summary.number("error_angle_rad"),
                         summary.number("error_angular_momentum"),
                         summary.number("energy_ratio") - 1.0);
    return fmt::format("stress norm {:.2g}, volume {:.2g}, angle {:.2g} rad off",
                       summary.number("error_stress_norm"), summary.number("error_volume_ratio"),
                       summary.number("error_angle_rad"));
  }

 private:
  static constexpr double omega = 2.3;   // rad/s
  static constexpr double radius = 0.8;  // m
  static double duration() { return 2 * std::numbers::pi / omega; }

  /// Soft enough for few steps where nodes are moved, stiff enough to hardly grow where they are
  /// not.
  material::LinearElasticParameters elastic() const {
    return {.youngs_modulus = m_turn == Turn::prescribed ? 1.0 : 4.4e7, .density = 1300.0};
  }

  solver::SimulationSetup<2> setup(std::shared_ptr<const material::Material> law) const {
    const auto line =
        basis::KnotLines::uniform(-2.0 * radius, 2.0 * radius, 2 * static_cast<int>(m_cells));
    solver::SimulationSetup<2> setup{.lines = {line, line}};
    m_run.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    setup.materials = {std::move(law)};
    setup.filling = {
        [](const Vector<2>& x) {
          return std::hypot(x[0], x[1]) < radius ? std::optional(0) : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(m_run.particles_per_cell_direction); }};
    return setup;
  }

  static double total_volume(const solver::Simulation<2>& simulation) {
    const auto view = simulation.particles().view();
    return petsc::sum(std::accumulate(view.volume, view.volume + view.count, 0.0));
  }

  void turn_nodes(solver::Simulation<2>& simulation, RunLoop<2>& loop) const {
    simulation.add_constraint(std::make_shared<RigidTurn>(omega, Vector<2>{0.0, 0.0}));
    {
      const auto view = simulation.particles().view();
      std::fill_n(view.stress[0], view.count, m_stress);
    }
    const auto steps = static_cast<double>(m_steps);
    loop.run({.name = "turn",
              .share_done = [&] { return static_cast<double>(loop.clock().step) / steps; },
              .longest_step = duration() / steps});
  }

  /// How the disc turns as a whole.
  struct Spin {
    double angle = 0.0;             ///< rad, of the best rigid fit, between -pi and pi
    double angular_momentum = 0.0;  ///< kg m^2/s per metre
  };

  /// Collective.
  static Spin measure(const solver::Simulation<2>& simulation) {
    const auto view = simulation.particles().view();
    double cosine = 0.0, sine = 0.0, moment = 0.0;
    for (int p = 0; p < view.count; ++p) {
      const Vector<2> x = view.position_of(p), v = view.velocity_of(p);
      const Vector<2> X{x[0] - view.displacement[0][p], x[1] - view.displacement[1][p]};
      cosine += view.mass[p] * (X[0] * x[0] + X[1] * x[1]);
      sine += view.mass[p] * (X[0] * x[1] - X[1] * x[0]);
      moment += view.mass[p] * (x[0] * v[1] - x[1] * v[0]);
    }
    return {std::atan2(petsc::sum(sine), petsc::sum(cosine)), petsc::sum(moment)};
  }

  /// Largest norm of the elastic strain, all of which one step from rest has made.
  static double largest_strain(const solver::Simulation<2>& simulation,
                               const material::LinearElastic& law) {
    const auto view = simulation.particles().view();
    double largest = 0.0;
    for (int p = 0; p < view.count; ++p) {
      SymmetricTensor stress;
      for (int k = 0; k < tensor_components<2>; ++k) stress[k] = view.stress[k][p];
      largest = std::max(largest, norm(law.elastic_strain(stress)));
    }
    return petsc::maximum(largest);
  }

  void start_spinning(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      view.velocity[0][p] = -omega * view.position[1][p];
      view.velocity[1][p] = omega * view.position[0][p];
    }
  }

  void spin(solver::Simulation<2>& simulation, RunLoop<2>& loop, const material::LinearElastic& law,
            io::Summary& summary) const {
    io::CsvFile history(
        m_run.output_dir + "/history.csv",
        {"time_s", "error_angle_rad", "angular_momentum_ratio", "kinetic_energy_J_per_m",
         "strain_energy_J_per_m", "total_energy_J_per_m", "dt_s", "step"});
    start_spinning(simulation);
    EnergyMeter<2> meter(simulation, law);
    const Spin start = measure(simulation);
    Spin now = start;
    Energies energies = meter.start();
    double strain_rate = 0.0, angle = 0.0, angle_error = 0.0, moment_ratio = 1.0;
    loop.run({.name = "spin",
              .share_done = [&] { return loop.clock().time_in_stage / duration() + 1e-12; },
              .after_step =
                  [&] {
                    const run::Clock& clock = loop.clock();
                    if (strain_rate == 0.0)
                      strain_rate = largest_strain(simulation, law) / clock.dt;
                    const Spin before = std::exchange(now, measure(simulation));
                    angle += std::remainder(now.angle - before.angle, 2 * std::numbers::pi);
                    angle_error = angle - omega * clock.time;
                    moment_ratio = now.angular_momentum / start.angular_momentum;
                    energies = meter.after_step(clock.time);
                    if (m_run.row_is_due(clock.step))
                      history.row({energies.time, angle_error, moment_ratio, energies.kinetic,
                                   energies.strain, energies.total(), clock.dt,
                                   static_cast<double>(clock.step)});
                  },
              .end_time = duration()});
    summary.set("error_angle_rad", angle_error);
    summary.set("error_angular_momentum", moment_ratio - 1.0);
    summary.set("energy_ratio", energies.total() / meter.start().total());
    summary.set("largest_strain_rate_over_omega", strain_rate / omega);
  }

  void report_stress(const solver::Simulation<2>& simulation, io::Summary& summary) const {
    const auto view = simulation.particles().view();
    double norm_error = 0.0, angle_error = 0.0;
    for (int p = 0; p < view.count; ++p) {
      const double xx = view.stress[0][p], yy = view.stress[1][p], xy = view.stress[3][p];
      norm_error = std::max(norm_error,
                            std::abs(std::sqrt(xx * xx + yy * yy + 2 * xy * xy) / m_stress - 1.0));
      angle_error = std::max(angle_error, std::abs(0.5 * std::atan2(2 * xy, xx - yy)));
    }
    summary.set("error_stress_norm", petsc::maximum(norm_error));
    summary.set("error_angle_rad", petsc::maximum(angle_error));
  }

  run::RunOptions m_run;
  Turn m_turn = Turn::prescribed;
  std::int64_t m_cells = 8;
  std::int64_t m_steps = 1000;
  double m_stress = 3e4;
};

}  // namespace

std::unique_ptr<Scene> make_rotation() {
  return std::make_unique<Rotation>();
}

}  // namespace mpm::scene
