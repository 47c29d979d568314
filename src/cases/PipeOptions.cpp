#include "mpm/cases/PipeOptions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/cases/ContactDetection.hpp"
#include "mpm/cases/PipeEvidence.hpp"
#include "mpm/core/Errors.hpp"

namespace mpm::cases {
namespace {

constexpr double largest_grid = 1e9;                     // cells
constexpr double fine_beside_pipe = 3.0;                 // D from the axis
constexpr double fine_below_end = 2.0;                   // D below the invert's last position
constexpr double nearest_bottom = 1.0;                   // D below the invert's last position
constexpr double deep_enough = 8.0, wide_enough = 10.0;  // D: the bottom adds 14 % and less
constexpr double fewest_grains = 3.0;                    // a cell
constexpr double air_above = 1.5;                        // D, room for heave
constexpr double flip_time_over_fall_time = 0.016;       // of sqrt(D/g): 30 steps or so
constexpr double pace_time_over_fall_time = 0.5;  // of sqrt(D/g): slow, or speed and reaction swing
constexpr double inertia_length = 0.0025;         // D: then the share is about the error of N_d

}  // namespace

PipeOptions::PipeOptions() : checks(pipe_checks()) {
  run.output_dir = "out/pipe";
  run.averages_volume = true;
  run.default_flip_time = fmt::format("{} sqrt(D/g)", flip_time_over_fall_time);
  sand.parameters().cohesion = 1000.0;
}

void PipeOptions::declare(options::OptionSet& options) {
  run.declare(options);
  declare_pipe(options);
  declare_grid(options);
  declare_contact(options);
  declare_geostatic(options);
  checks.declare(options);
  sand.declare(options);
}

void PipeOptions::declare_pipe(options::OptionSet& options) {
  options.section("Pipe");
  options.real("pipe_diameter", diameter, options::between(1e-3, 20.0),
               {"m", "outer diameter D", "paper, section 4.1"});
  options.real(
      "pipe_embedment_ratio", embedment_ratio, {.minimum = 1.0, .maximum = 100.0},
      {"1", "depth of the springline below the surface over D, H/D", "paper, section 4.1"});
  options.optional_real("pipe_velocity", velocity,
                        {.minimum = 0.0, .maximum = 100.0, .open_minimum = true},
                        "as fast as -inertia_tolerance allows",
                        {"m/s", "downward velocity after the ramp",
                         "docs/verification/pipe.md; the paper uses 0.004"});
  options.real("inertia_tolerance", inertia_tolerance, {.minimum = 1e-4, .maximum = 10.0},
               {"1",
                "for -pipe_velocity auto: largest kinetic energy of the soil over the work of the "
                "reaction on D/400, which is about the share that inertia adds to N_d",
                "docs/verification/pipe.md"});
  options.effective([this] { return !velocity; }, "only with -pipe_velocity auto");
  options.real("pipe_end_displacement", end_displacement,
               {.minimum = 0.0, .maximum = 5.0, .open_minimum = true},
               {"D", "displacement at which the run ends, u/D", "paper, section 4.1"});
  options.real("pipe_ramp_distance", ramp_distance, options::between(0.0, 1.0),
               {"D", "displacement over which a given velocity rises as (1 - cos)/2", "chosen"});
  options.effective([this] { return velocity.has_value(); }, "only with a given -pipe_velocity");
}

std::shared_ptr<contact::PacedMotion<2>> PipeOptions::paced_motion() const {
  return velocity ? nullptr : std::make_shared<contact::PacedMotion<2>>(Vector<2>{0.0, -1.0});
}

std::shared_ptr<contact::Motion<2>> PipeOptions::ramped_motion() const {
  return std::make_shared<contact::RampMotion<2>>(
      Vector<2>{0.0, -1.0}, contact::Ramp{velocity.value(), ramp_distance * diameter});
}

run::InertiaOptions PipeOptions::inertia() const {
  const double modelled = is_half() ? 0.5 : 1.0;
  return {.length = inertia_length * diameter,
          .tolerance = inertia_tolerance,
          .smallest_mass = modelled * density() * diameter * diameter,
          .time = pace_time_over_fall_time * std::sqrt(diameter / gravity),
          .smallest_force = modelled * unit_weight() * std::numbers::pi * radius() * radius()};
}

void PipeOptions::declare_grid(options::OptionSet& options) {
  options.section("Grid of the pipe scene");
  options.integer("pipe_cells_per_diameter", cells_per_diameter, {2, 1000},
                  {"1", "cells per D near the pipe", "paper, section 4.2"});
  options.integer("particles_per_cell_near_pipe", particles_near_pipe, {1, 16},
                  {"1",
                   "particles per cell and direction within 1.5 D of the pipe's axis and of "
                   "its path",
                   "chosen"});
  options.real("pipe_domain_width", domain_width, {.minimum = 1.0, .maximum = 1000.0},
               {"D", "from the pipe's axis to each side wall", "paper, section 3.3"});
  options.real("pipe_domain_depth_below", domain_depth_below, {.minimum = 1.0, .maximum = 1000.0},
               {"D", "from the pipe's invert to the bottom", "paper, section 3.3"});
  options.real("pipe_far_cell_ratio", far_cell_ratio, options::between(1.0, 100.0),
               {"1",
                "largest cells of the far field over those near the pipe; neighbours differ by "
                "5 % at most",
                "docs/model.md"});
  options.choice(
      "symmetry", symmetry,
      {{"auto", Symmetry::automatic}, {"half", Symmetry::half}, {"full", Symmetry::full}},
      {"",
       "model half of the soil or all of it; auto takes half, since a pipe that moves "
       "straight down is symmetric",
       "paper, section 3.3"});
  check_domain(options);
}

/// Of walls that are too near. The figures are those of docs/checks.md.
void PipeOptions::check_domain(options::OptionSet& options) {
  options.rule([this, &options] {
    if (domain_depth_below - end_displacement >= nearest_bottom) return;
    throw options::bad_input({options.given("pipe_domain_depth_below"),
                              fmt::format("leaves {:.3g} D below the pipe at the end of its way",
                                          domain_depth_below - end_displacement),
                              fmt::format("at least -pipe_end_displacement {} and {} D more",
                                          end_displacement, nearest_bottom),
                              "make the domain deeper or the way shorter"});
  });
  options.caution([this] {
    if (domain_depth_below >= deep_enough && domain_width >= wide_enough) return std::string();
    return fmt::format(
        "-pipe_domain_width {} and -pipe_domain_depth_below {}: the walls add to the resistance; "
        "at u/D = 0.05 a half width of 7 D makes it 1.3 times that of 20 D x 14 D, a depth of 5 D "
        "1.35 times and 2 D x 2 D 4 times",
        domain_width, domain_depth_below);
  });
  options.caution([this] {
    const double grains = cell() / sand.parameters().d50;
    if (grains >= fewest_grains) return std::string();
    return fmt::format(
        "-pipe_cells_per_diameter {}: a cell is {:.2g} grains wide (-sand_d50 {} m), and no soil "
        "is a continuum below some {}",
        cells_per_diameter, grains, sand.parameters().d50, fewest_grains);
  });
}

void PipeOptions::declare_contact(options::OptionSet& options) {
  options.section("Contact");
  declare_detection(options, detection, gap_cells);
  options.choice("contact_normal", normal,
                 {{"surface", contact::Normal::surface}, {"gradient", contact::Normal::gradient}},
                 {"", "normal of the pipe itself, or of its nodal mass (gradient, the paper)",
                  "docs/model.md"});
  options.effective([this] { return !contact::detection_kinds()[detection].is_by_springs(); },
                    "-contact_detection spring has the normal of the pipe");
  options.optional_real("contact_friction", friction, {.minimum = 0.0, .maximum = 10.0},
                        "tan(0.6 phi_c)",
                        {"1", "Coulomb coefficient between sand and pipe", "paper, section 3.3"});
}

void PipeOptions::declare_geostatic(options::OptionSet& options) {
  options.section("Geostatic stage");
  options.choice(
      "geostatic", geostatic, {{"prescribed", Geostatic::prescribed}},
      {"", "how the stress at rest comes about: prescribed and then relaxed", "docs/model.md"});
  options.real("geostatic_K0", K0, {.minimum = 0.05, .maximum = 5.0},
               {"1", "horizontal over vertical stress at the start", "chosen: 1 - sin 30 degrees"});
  options.real("gravity", gravity, options::positive(), {"m/s^2", "downward", ""});
  options.real("damping", damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
               {"1", "local damping of the geostatic stage only, f -= damping |f| sign(v)",
                "docs/model.md"});
  options.real("geostatic_tolerance", geostatic_tolerance, {.minimum = 1e-12, .maximum = 0.1},
               {"1", "the stage ends when sum |f| falls below this share of the soil's weight",
                "docs/model.md"});
  options.real("geostatic_stress_tolerance", geostatic_stress_tolerance,
               {.minimum = 1e-6, .maximum = 1.0},
               {"1",
                "largest rms error of vertical stress and of K0 beyond 2 D from the pipe at the "
                "end of the stage",
                "docs/model.md; open_knot walls need about 0.05"});
  options.real("geostatic_reaction_tolerance", geostatic_reaction_tolerance,
               {.minimum = 1e-6, .maximum = 10.0},
               {"1",
                "largest relative error of N_d at the end of the stage, against pi/(4 H/D), the "
                "weight of the soil in the pipe's place",
                "docs/model.md; contact found on nodes needs 0.3 and more"});
}

double PipeOptions::friction_coefficient() const {
  return friction.value_or(std::tan(0.6 * material::critical_friction_angle(sand.parameters())));
}

double PipeOptions::density() const {
  return 1000.0 * sand.parameters().Gs / (1.0 + sand.parameters().void_ratio);
}

basis::KnotLines PipeOptions::horizontal_lines() const {
  const double width = domain_width * diameter, fine = fine_beside_pipe * diameter;
  return basis::KnotLines::graded({.begin = is_half() ? 0.0 : -width,
                                   .end = width,
                                   .fine_begin = -fine,
                                   .fine_end = fine,
                                   .origin = 0.0,
                                   .cell = cell(),
                                   .ratio = far_cell_ratio});
}

basis::KnotLines PipeOptions::vertical_lines() const {
  const double invert = depth() + radius();
  const double air = air_above * diameter;
  return basis::KnotLines::graded(
      {.begin = -(invert + domain_depth_below * diameter),
       .end = air,
       .fine_begin = -(invert + (end_displacement + fine_below_end) * diameter),
       .fine_end = air,
       .origin = 0.0,
       .cell = cell(),
       .ratio = far_cell_ratio});
}

particles::Filling<2> PipeOptions::filling(bool graded) const {
  const double R = radius(), H = depth();
  const double lowest = -H - end_displacement * diameter;
  const auto near = static_cast<int>(particles_near_pipe);
  const auto far = static_cast<int>(run.particles_per_cell_direction);
  const double reach = 1.5 * diameter;
  return {[=](const Vector<2>& x) {
            const bool soil = x[1] < 0.0 && std::hypot(x[0], x[1] + H) > R;
            return soil ? std::optional(0) : std::nullopt;
          },
          [=](const Vector<2>& x) {
            const double y = std::clamp(x[1], lowest, -H);  // nearest point of the axis' path
            return std::hypot(x[0], x[1] - y) < reach ? std::max(near, far) : far;
          },
          graded ? particles::Placement::gauss : particles::Placement::midpoint};
}

solver::SimulationSetup<2> PipeOptions::setup() const {
  const double cells_per_D = static_cast<double>(cells_per_diameter);
  const double width = (is_half() ? 1.0 : 2.0) * domain_width;
  const double height = embedment_ratio + 0.5 + domain_depth_below + air_above;
  if (width * height * cells_per_D * cells_per_D / (far_cell_ratio * far_cell_ratio) > largest_grid)
    throw BadInput(
        fmt::format("-pipe_cells_per_diameter {} on {} D x {} D makes more than 1e9 "
                    "cells; take fewer, a smaller domain or a larger "
                    "-pipe_far_cell_ratio",
                    cells_per_diameter, width, height));
  using grid::Wall;
  solver::SimulationSetup<2> setup{.lines = {horizontal_lines(), vertical_lines()}};
  run.apply_to(setup);
  if (!run.flip_time) setup.flip_time = flip_time_over_fall_time * std::sqrt(diameter / gravity);
  setup.walls = {
      {{is_half() ? Wall::symmetry : Wall::roller, Wall::roller}, {Wall::fixed, Wall::free}}};
  if (contact::detection_kinds()[detection].is_by_springs()) setup.particle_contacts = {"contact"};
  setup.materials = {sand.create()};
  setup.filling = filling(!setup.lines[0].is_uniform() || !setup.lines[1].is_uniform());
  setup.gravity = {0.0, -gravity};
  return setup;
}

std::vector<Vector<2>> PipeOptions::points_in_pipe(double spacing) const {
  std::vector<Vector<2>> points;
  const int n = static_cast<int>(std::ceil(radius() / spacing));
  for (int j = -n; j < n; ++j)
    for (int i = is_half() ? 0 : -n; i < n; ++i) {
      const Vector<2> r{(i + 0.5) * spacing, (j + 0.5) * spacing};
      if (std::hypot(r[0], r[1]) < radius()) points.push_back(r);
    }
  return points;
}

}  // namespace mpm::cases
