#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "mpm/cases/GridCase.hpp"
#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

enum class Shape { block, disc };

/// How far the centre of mass has come along x.
class Slide : public run::Observer<2> {
 public:
  void after_step(const run::Moment<2>& now) override {
    velocity = now.simulation.momentum()[0] / now.simulation.total_mass();
    way += velocity * now.clock.dt;
  }
  void persist(Archive& archive) override {
    archive("way", way);
    archive("velocity", velocity);
  }

  double way = 0.0;       ///< m
  double velocity = 0.0;  ///< m/s
};

/// A stiff elastic body on a rigid incline; x runs down the incline and gravity is turned instead.
/// Exact for a rigid body: the acceleration down the incline is g (sin a - mu cos a) while it
/// slides; a block stays where mu > tan a, a disc rolls with 2/3 g sin a where mu > tan(a)/3, since
/// its moment of inertia is m R^2/2. The elastic body shakes a little when it starts, less the
/// stiffer it is.
class Incline : public GridCase<2> {
 public:
  Incline() {
    m_options.output_dir = "out/incline";
    m_options.largest_courant = 0.5;
    m_material.parameters() = {.youngs_modulus = 2e9, .poisson_ratio = 0.3, .density = 1900.0};
  }

  void declare(options::OptionSet& options) override {
    m_options.declare(options);
    options.section("Incline");
    options.choice("body", m_shape, {{"block", Shape::block}, {"disc", Shape::disc}},
                   {"", "shape of the body", "chosen"});
    options.integer("cells", m_cells, {2, 1000},
                    {"1", "cells over the height of the body", "chosen"});
    options.real("incline_angle", m_angle, options::between(0.0, 80.0),
                 {"degrees", "slope of the incline", "chosen"});
    options.real("contact_friction", m_friction, options::not_negative(),
                 {"1", "Coulomb coefficient mu", "chosen"});
    options.real("gravity", m_gravity, options::positive(), {"m/s^2", "downward", "chosen"});
    options.choice("contact_detection", m_detection,
                   {{"auto", std::nullopt},
                    {"gap", contact::detection_named("gap")},
                    {"particle", contact::detection_named("particle")},
                    {"spring", contact::detection_named("spring")}},
                   {"",
                    "bodies touch on nodes at or below the plane (gap), on those if most particles "
                    "beside it there touch it (particle), or where a particle's own extent meets "
                    "it (spring); auto takes gap for the block, particle for the disc",
                    "docs/verification/incline.md"});
    m_material.declare(options);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("slid {:.5g} m, exact {:.5g} m", summary.number("slide_m"),
                       summary.number("slide_exact_m"));
  }

 private:
  static constexpr double height = 0.5;              // m, of the block; diameter of the disc
  static constexpr double touching_distance = 0.01;  // cells, of a node from the plane
  static constexpr double duration = 0.6;            // s
  double length() const { return m_shape == Shape::disc ? height : 2.0 * height; }  // m
  double cell() const { return height / static_cast<double>(m_cells); }
  double plane_height() const { return 4 * cell(); }
  std::size_t detection() const {
    return m_detection.value_or(
        contact::detection_named(m_shape == Shape::disc ? "particle" : "gap"));
  }
  Vector<2> start() const { return {4 * cell() + 0.5 * length(), plane_height() + 0.5 * height}; }
  double radians() const { return m_angle * std::numbers::pi / 180.0; }
  double exact_acceleration() const {
    const double held = m_shape == Shape::disc ? 2.0 / 3.0 * std::sin(radians()) : 0.0;
    return m_gravity * std::max(held, std::sin(radians()) - m_friction * std::cos(radians()));
  }

  /// Bends the rows of a square around its centre into rings of the disc within it, areas in
  /// proportion (Shirley & Chiu 1997): a disc cut out of a lattice has flats on which it rests.
  void round_off(solver::Simulation<2>& simulation) const {
    constexpr double quarter = 0.25 * std::numbers::pi;
    const auto view = simulation.particles().view();
    const auto [x0, y0] = start();
    for (int p = 0; p < view.count; ++p) {
      const double x = view.position[0][p] - x0, y = view.position[1][p] - y0;
      const bool beside = std::abs(x) > std::abs(y);
      const double radius = beside ? x : y, angle = quarter * (beside ? y / x : x / y);
      view.position[0][p] = x0 + radius * (beside ? std::cos(angle) : std::sin(angle));
      view.position[1][p] = y0 + radius * (beside ? std::sin(angle) : std::cos(angle));
      view.volume[p] *= quarter;
      view.mass[p] *= quarter;
    }
  }

  run::Problem<2> problem() override {
    m_slide = std::make_shared<Slide>();
    run::Problem<2> problem{.setup = setup()};
    const Vector<2> inclined = problem.setup.gravity;
    if (m_shape == Shape::disc)
      problem.arrange = [this](solver::Simulation<2>& simulation) { round_off(simulation); };
    problem.constraints = {[this](const solver::Simulation<2>& simulation) {
      return contact_of(simulation, ground(plane_height()),
                        {.detection = detection(),
                         .gap_cells = touching_distance,
                         .friction = m_friction,
                         .reference_density = m_material.parameters().density});
    }};
    problem.stages = {rest_on_level_plane(inclined), slide_down(inclined)};
    problem.observers = {m_slide, std::make_shared<run::History<2>>(history())};
    return problem;
  }

  /// Lets the body come to rest before the plane is tilted, so that it does not bounce.
  run::Stage<2> rest_on_level_plane(const Vector<2>& inclined) const {
    return {.name = "settling",
            .ending = std::make_shared<run::AtRest<2>>(run::RestOptions<2>{
                .tolerance = m_shape == Shape::disc ? 0.05 : 1e-4, .longest = 1'000'000}),
            .is_main = false,
            .damping = 0.3,
            .gravity = Vector<2>{0.0, inclined[1]}};
  }

  static run::Stage<2> slide_down(const Vector<2>& inclined) {
    return {.name = "sliding",
            .ending = std::make_shared<run::AfterTime<2>>(duration),
            .begins_at_rest = true,
            .gravity = inclined};
  }

  run::HistoryTable<2> history() const {
    return {
        .path = path("history.csv"),
        .columns = {"time_s", "slide_m", "velocity_m_per_s"},
        .row =
            [this](const run::Moment<2>& now) {
              return std::vector<double>{now.clock.time_in_stage, m_slide->way, m_slide->velocity};
            },
        .cadence = every_step()};
  }

  void evaluate(run::Run<2>&, io::Summary& summary) override {
    const double exact = 0.5 * exact_acceleration() * duration * duration;
    summary.set("slide_m", m_slide->way);
    summary.set("slide_exact_m", exact);
    if (exact > 0.0) summary.set("error_slide", m_slide->way / exact - 1.0);
  }

  solver::SimulationSetup<2> setup() const {
    const double free_path = 0.5 * m_gravity * duration * duration;
    const int cells_x = static_cast<int>(std::ceil((length() + free_path) / cell())) + 8;
    const int cells_y = static_cast<int>(m_cells) + 8;
    solver::SimulationSetup<2> setup{
        .lines = {basis::KnotLines::uniform(0.0, cells_x * cell(), cells_x),
                  basis::KnotLines::uniform(0.0, cells_y * cell(), cells_y)}};
    m_options.apply_to(setup);
    setup.walls = {{{grid::Wall::free, grid::Wall::free}, {grid::Wall::free, grid::Wall::free}}};
    if (contact::detection_kinds()[detection()].is_by_springs())
      setup.particle_contacts = {"contact"};
    setup.materials = {m_material.create()};
    const Vector<2> centre = start();
    setup.filling.material_at = [this, centre](const Vector<2>& x) {
      const double across = x[0] - centre[0], up = x[1] - centre[1];
      const bool inside = std::abs(across) < 0.5 * length() && std::abs(up) < 0.5 * height;
      return inside ? std::optional(0) : std::nullopt;
    };
    setup.gravity = {m_gravity * std::sin(radians()), -m_gravity * std::cos(radians())};
    return setup;
  }

  std::shared_ptr<Slide> m_slide;
  Shape m_shape = Shape::block;
  std::optional<std::size_t> m_detection;
  std::int64_t m_cells = 5;
  double m_angle = 35.0;
  double m_friction = 0.4;
  double m_gravity = 9.81;
  mutable material::LinearElasticFactory m_material;
};

}  // namespace

std::unique_ptr<Case> make_incline() {
  return std::make_unique<Incline>();
}

}  // namespace mpm::cases
