#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "mpm/cases/EnergyMeter.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

double dot(const Vector<2>& a, const Vector<2>& b) {
  return a[0] * b[0] + a[1] * b[1];
}

constexpr double direction = std::numbers::pi / 7.0;  // of the line of centres

Vector<2> along(double distance) {
  return {distance * std::cos(direction), distance * std::sin(direction)};
}

/// Mass and momentum of a disc. Collective.
struct Body {
  double mass = 0.0;
  Vector<2> momentum{};
};
std::array<Body, 2> measure(const solver::Simulation<2>& simulation) {
  std::array<Body, 2> bodies;
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p) {
    Body& body = bodies[static_cast<std::size_t>(view.material[p])];
    body.mass += view.mass[p];
    for (int d = 0; d < 2; ++d) body.momentum[d] += view.mass[p] * view.velocity[d][p];
  }
  for (Body& body : bodies) {
    body.mass = petsc::sum(body.mass);
    for (double& component : body.momentum) component = petsc::sum(component);
  }
  return bodies;
}

/// Of the centres of mass, along the line on which they came, m/s.
double closing_speed(const std::array<Body, 2>& bodies) {
  return dot(bodies[0].momentum, along(1.0 / bodies[0].mass)) -
         dot(bodies[1].momentum, along(1.0 / bodies[1].mass));
}

/// Follows momentum and closing speed of two discs.
class Collision : public run::Observer<2> {
 public:
  /// Speed of each disc towards the other at the start, m/s.
  explicit Collision(double speed_of_each) : m_speed(speed_of_each) {}

  void begin(const run::Moment<2>& now) override {
    const std::array<Body, 2> bodies = measure(now.simulation);
    m_momentum = now.simulation.momentum();
    m_of_one_disc = bodies[0].mass * m_speed;
    first_speed = closing_speed(bodies);
    energy_of_centre = 0.5 * dot(m_momentum, m_momentum) / now.simulation.total_mass();
  }
  void after_step(const run::Moment<2>& now) override {
    const Vector<2> momentum = now.simulation.momentum();
    error = std::hypot(momentum[0] - m_momentum[0], momentum[1] - m_momentum[1]) / m_of_one_disc;
    largest_error = std::max(largest_error, error);
    speed = closing_speed(measure(now.simulation));
  }
  void persist(Archive& archive) override {
    archive("momentum", m_momentum);
    archive("of_one_disc", m_of_one_disc);
    archive("first_speed", first_speed);
    archive("energy_of_centre", energy_of_centre);
    archive("error", error);
    archive("largest_error", largest_error);
    archive("speed", speed);
  }

  double error = 0.0, largest_error = 0.0;  ///< of the momentum, as a share of one disc's
  double speed = 0.0, first_speed = 0.0;    ///< of closing, m/s
  double energy_of_centre = 0.0;            ///< kinetic, of the common centre of mass, J/m

 private:
  double m_speed;
  Vector<2> m_momentum{};
  double m_of_one_disc = 0.0;
};

/// Two elastic discs fly at each other in a moving frame, along a line that no grid line follows,
/// and collide on the grid they share; nothing else makes contact. Exact: momentum and total energy
/// stay; slow equal discs get nearly all kinetic energy back, others keep vibrating. Energies are
/// those in the frame of the common centre of mass.
class Discs : public GridCase<2> {
 public:
  Discs() {
    m_options.output_dir = "out/discs";
    m_options.largest_courant = 0.4;
    m_material.parameters() = {.youngs_modulus = 1000.0, .poisson_ratio = 0.3, .density = 1000.0};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Discs");
    options.integer("cells", m_cells, {4, 1000},
                    {"1", "cells per diameter of the larger disc", "chosen"});
    options.real("start_velocity", m_speed, options::positive(),
                 {"m/s", "of each disc towards the other, in the frame of both", "chosen"});
    options.real("second_disc_radius", m_second_radius, options::between(0.05, 0.2),
                 {"m", "the first disc has 0.2 m", "chosen"});
    m_material.declare(options);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("kinetic energy returned {:.4f}, restitution {:.4f}, momentum {:.2g} off",
                       summary.number("energy_ratio"), summary.number("restitution"),
                       summary.number("error_momentum"));
  }

 private:
  static constexpr double first_radius = 0.2;  // m
  static constexpr double gap = 0.1;           // m, between the discs at the start
  /// Of the frame, as a share of the discs' velocity in it, so that they have momentum together.
  static constexpr double drift = 0.5;
  static constexpr int cells_of_air = 4;
  /// Duration of collision and vibration, in times of a wave through both radii.
  static constexpr double collision_in_transits = 5.0;

  double radius(int disc) const { return disc == 0 ? first_radius : m_second_radius; }
  /// Discs touch at the origin if they meet undeformed.
  Vector<2> centre(int disc) const {
    const double distance = 0.5 * gap + radius(disc);
    return along(disc == 0 ? -distance : distance);
  }
  double cell() const { return 2.0 * first_radius / static_cast<double>(m_cells); }
  /// Flight over half the gap each, and back; and a collision, with time to vibrate afterwards.
  double duration() const {
    const auto [E, nu, density] = m_material.parameters();
    const double wave_speed = std::sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / density);
    return gap / m_speed + collision_in_transits * (radius(0) + radius(1)) / wave_speed;
  }
  /// Where a disc would be at the end if the collision took no time and no energy.
  Vector<2> last_centre(int disc) const {
    const double m0 = radius(0) * radius(0), m1 = radius(1) * radius(1);
    const double rebound = 2.0 * (m0 - m1) / (m0 + m1) * m_speed + (disc == 0 ? -m_speed : m_speed);
    const double distance = disc == 0 ? -radius(0) : radius(1);
    return along(distance + rebound * (duration() - 0.5 * gap / m_speed) +
                 drift * m_speed * duration());
  }

  solver::SimulationSetup<2> setup() const {
    solver::SimulationSetup<2> setup{.lines = {line(0), line(1)}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    // Two laws of one kind: the number of the material tells the disc.
    setup.materials = {m_material.create(), m_material.create()};
    setup.filling.material_at = [this](const Vector<2>& x) -> std::optional<int> {
      for (int disc = 0; disc < 2; ++disc) {
        const Vector<2> c = centre(disc);
        if (std::hypot(x[0] - c[0], x[1] - c[1]) < radius(disc)) return disc;
      }
      return std::nullopt;
    };
    return setup;
  }

  /// Room for both discs where they start and where they can be at the end.
  basis::KnotLines line(int d) const {
    double lowest = centre(0)[d], highest = lowest;
    for (int disc = 0; disc < 2; ++disc)
      for (const Vector<2>& c : {centre(disc), last_centre(disc)}) {
        lowest = std::min(lowest, c[d] - radius(disc));
        highest = std::max(highest, c[d] + radius(disc));
      }
    const double begin = std::floor(lowest / cell()) - cells_of_air;
    const double end = std::ceil(highest / cell()) + cells_of_air;
    return basis::KnotLines::uniform(begin * cell(), end * cell(), static_cast<int>(end - begin));
  }

  void start_moving(solver::Simulation<2>& simulation) const {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const Vector<2> v = along((view.material[p] == 0 ? 1.0 + drift : drift - 1.0) * m_speed);
      for (int d = 0; d < 2; ++d) view.velocity[d][p] = v[d];
    }
  }

  run::Problem<2> problem() override {
    m_collision = std::make_shared<Collision>(m_speed);
    m_energies = std::make_shared<EnergyMeter<2>>(
        std::make_shared<const material::LinearElastic>(m_material.parameters()));
    run::Problem<2> problem{.setup = setup()};
    problem.arrange = [this](solver::Simulation<2>& simulation) { start_moving(simulation); };
    problem.stages = {
        {.name = "collision", .ending = std::make_shared<run::AfterTime<2>>(duration())}};
    problem.observers = {m_collision, m_energies, std::make_shared<run::History<2>>(history())};
    return problem;
  }

  run::HistoryTable<2> history() const {
    return {.path = path("history.csv"),
            .columns = {"time_s", "closing_speed_m_per_s", "error_momentum",
                        "kinetic_energy_J_per_m", "strain_energy_J_per_m", "total_energy_J_per_m"},
            .row =
                [this](const run::Moment<2>&) {
                  const Energies& now = m_energies->now;
                  const double of_centre = m_collision->energy_of_centre;
                  return std::vector<double>{now.time,           m_collision->speed,
                                             m_collision->error, now.kinetic - of_centre,
                                             now.strain,         now.total() - of_centre};
                },
            .cadence = every_step()};
  }

  void evaluate(run::Run<2>&, io::Summary& summary) override {
    const double of_centre = m_collision->energy_of_centre;
    const double available = m_energies->start.total() - of_centre;
    summary.set("error_momentum", m_collision->largest_error);
    summary.set("energy_ratio", (m_energies->now.kinetic - of_centre) / available);
    summary.set("total_energy_ratio", (m_energies->now.total() - of_centre) / available);
    summary.set("restitution", -m_collision->speed / m_collision->first_speed);
  }

  std::shared_ptr<Collision> m_collision;
  std::shared_ptr<EnergyMeter<2>> m_energies;
  std::int64_t m_cells = 40;
  double m_speed = 0.1;
  double m_second_radius = first_radius;
  mutable material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Case> make_discs() {
  return std::make_unique<Discs>();
}

}  // namespace mpm::cases
