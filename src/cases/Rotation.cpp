#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "mpm/cases/EnergyMeter.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

constexpr double omega = 2.3;   // rad/s
constexpr double radius = 0.8;  // m
double duration() {
  return 2 * std::numbers::pi / omega;
}

/// How the disc turns as a whole.
struct Spin {
  double angle = 0.0;             ///< rad, of the best rigid fit, between -pi and pi
  double angular_momentum = 0.0;  ///< kg m^2/s per metre
};

/// Collective.
Spin measure(const solver::Simulation<2>& simulation) {
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
double largest_strain(const solver::Simulation<2>& simulation, const material::LinearElastic& law) {
  const auto view = simulation.particles().view();
  double largest = 0.0;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor stress;
    for (int k = 0; k < tensor_components<2>; ++k) stress[k] = view.stress[k][p];
    largest = std::max(largest, norm(law.elastic_strain(stress)));
  }
  return petsc::maximum(largest);
}

double total_volume(const solver::Simulation<2>& simulation) {
  const auto view = simulation.particles().view();
  return simulation.communicator().sum(std::accumulate(view.volume, view.volume + view.count, 0.0));
}

/// Of all particles before the first step, m^3 per metre.
class InitialVolume : public run::Observer<2> {
 public:
  void begin(const run::Moment<2>& now) override { at_start = total_volume(now.simulation); }
  void persist(Archive& archive) override { archive("at_start", at_start); }

  double at_start = 0.0;
};

/// Follows how a free disc turns.
class Spinning : public run::Observer<2> {
 public:
  explicit Spinning(std::shared_ptr<const material::LinearElastic> law) : m_law(std::move(law)) {}

  void begin(const run::Moment<2>& now) override {
    m_now = measure(now.simulation);
    m_first_momentum = m_now.angular_momentum;
  }
  void after_step(const run::Moment<2>& now) override {
    if (strain_rate == 0.0) strain_rate = largest_strain(now.simulation, *m_law) / now.clock.dt;
    const Spin before = std::exchange(m_now, measure(now.simulation));
    m_angle += std::remainder(m_now.angle - before.angle, 2 * std::numbers::pi);
    angle_error = m_angle - omega * now.clock.time;
    momentum_ratio = m_now.angular_momentum / m_first_momentum;
  }
  void persist(Archive& archive) override {
    archive("angle_now", m_now.angle);
    archive("momentum_now", m_now.angular_momentum);
    archive("first_momentum", m_first_momentum);
    archive("angle", m_angle);
    archive("angle_error", angle_error);
    archive("momentum_ratio", momentum_ratio);
    archive("strain_rate", strain_rate);
  }

  double angle_error = 0.0;     ///< rad
  double momentum_ratio = 1.0;  ///< angular momentum over that at the start
  double strain_rate = 0.0;     ///< largest of the first step, 1/s

 private:
  std::shared_ptr<const material::LinearElastic> m_law;
  Spin m_now;
  double m_first_momentum = 0.0, m_angle = 0.0;
};

/// Gives every node the velocity of a rigid turn, omega x (x_I - centre).
class RigidTurn : public grid::Constraint<2> {
 public:
  RigidTurn(double rate, Vector<2> centre) : m_omega(rate), m_centre(centre) {}

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
class Rotation : public GridCase<2> {
 public:
  Rotation() { m_options.output_dir = "out/rotation"; }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Rotation");
    options.integer("cells", m_cells, {4, 10'000}, {"1", "cells per diameter", "chosen"});
    options.choice("turn", m_turn, {{"prescribed", Turn::prescribed}, {"free", Turn::free}},
                   {"", "by given velocities of the nodes, or under its own inertia", "chosen"});
    options.integer("increments", m_steps, {4, 10'000'000},
                    {"1", "steps of a full prescribed turn", "chosen"});
    options.real("amplitude", m_stress, options::positive(),
                 {"Pa", "uniaxial stress at the start of a prescribed turn", "chosen"});
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
  /// Soft enough for few steps where nodes are moved, stiff enough to hardly grow where they are
  /// not.
  material::LinearElasticParameters elastic() const {
    return {.youngs_modulus = m_turn == Turn::prescribed ? 1.0 : 4.4e7, .density = 1300.0};
  }

  solver::SimulationSetup<2> setup(std::shared_ptr<const material::Material> law) const {
    const auto line =
        basis::KnotLines::uniform(-2.0 * radius, 2.0 * radius, 2 * static_cast<int>(m_cells));
    solver::SimulationSetup<2> setup{.lines = {line, line}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    setup.materials = {std::move(law)};
    setup.filling.material_at = [](const Vector<2>& x) {
      return std::hypot(x[0], x[1]) < radius ? std::optional(0) : std::nullopt;
    };
    return setup;
  }

  run::Problem<2> problem() override {
    const auto law = std::make_shared<const material::LinearElastic>(elastic());
    run::Problem<2> problem{.setup = setup(law)};
    m_volume = std::make_shared<InitialVolume>();
    problem.observers = {m_volume};
    m_turn == Turn::prescribed ? turn_nodes(problem) : spin(problem, law);
    return problem;
  }

  void turn_nodes(run::Problem<2>& problem) const {
    problem.arrange = [this](solver::Simulation<2>& simulation) {
      const auto view = simulation.particles().view();
      std::fill_n(view.stress[0], view.count, m_stress);
    };
    problem.constraints = {[](const auto&) {
      return std::make_shared<RigidTurn>(omega, Vector<2>{0.0, 0.0});
    }};
    problem.stages = {{.name = "turn",
                       .ending = std::make_shared<run::AfterSteps<2>>(m_steps),
                       .longest_step = duration() / static_cast<double>(m_steps)}};
  }

  void spin(run::Problem<2>& problem, const std::shared_ptr<const material::LinearElastic>& law) {
    m_spinning = std::make_shared<Spinning>(law);
    m_energies = std::make_shared<EnergyMeter<2>>(law);
    problem.arrange = [](solver::Simulation<2>& simulation) { start_spinning(simulation); };
    problem.stages = {{.name = "spin", .ending = std::make_shared<run::AfterTime<2>>(duration())}};
    problem.observers.insert(
        problem.observers.end(),
        {m_spinning, m_energies, std::make_shared<run::History<2>>(history())});
  }

  run::HistoryTable<2> history() const {
    return {.path = path("history.csv"),
            .columns = {"time_s", "error_angle_rad", "angular_momentum_ratio",
                        "kinetic_energy_J_per_m", "strain_energy_J_per_m", "total_energy_J_per_m"},
            .row =
                [this](const run::Moment<2>&) {
                  const Energies& now = m_energies->now;
                  return std::vector<double>{now.time,
                                             m_spinning->angle_error,
                                             m_spinning->momentum_ratio,
                                             now.kinetic,
                                             now.strain,
                                             now.total()};
                },
            .cadence = every_step()};
  }

  void evaluate(run::Run<2>& run, io::Summary& summary) override {
    summary.set("error_volume_ratio",
                std::abs(total_volume(run.simulation()) / m_volume->at_start - 1.0));
    if (m_turn == Turn::prescribed) return report_stress(run.simulation(), summary);
    summary.set("error_angle_rad", m_spinning->angle_error);
    summary.set("error_angular_momentum", m_spinning->momentum_ratio - 1.0);
    summary.set("energy_ratio", m_energies->now.total() / m_energies->start.total());
    summary.set("largest_strain_rate_over_omega", m_spinning->strain_rate / omega);
  }

  static void start_spinning(solver::Simulation<2>& simulation) {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      view.velocity[0][p] = -omega * view.position[1][p];
      view.velocity[1][p] = omega * view.position[0][p];
    }
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

  std::shared_ptr<InitialVolume> m_volume;
  std::shared_ptr<Spinning> m_spinning;
  std::shared_ptr<EnergyMeter<2>> m_energies;
  Turn m_turn = Turn::prescribed;
  std::int64_t m_cells = 8;
  std::int64_t m_steps = 1000;
  double m_stress = 3e4;
};

}  // namespace

std::unique_ptr<Case> make_rotation() {
  return std::make_unique<Rotation>();
}

}  // namespace mpm::cases
