#include "mpm/cases/BiaxialOptions.hpp"

#include <fmt/format.h>

#include <cmath>

#include "mpm/cases/Evidence.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/particles/SurfacePieces.hpp"

namespace mpm::cases {

BiaxialOptions::BiaxialOptions()
    : checks({{.name = "reactions",
               .limits = {0.05, 0.2},
               .sentence = "rms difference of the plate's force by contact and by the momentum of "
                           "the soil",
               .remedy = "a smaller -biaxial_velocity may help"},
              limits_of_law()}) {
  run.output_dir = "out/biaxial";
  run.largest_courant = 0.9;
  run.flip_time =
      0.01;  // else particles at the free sides end up with 10 m/s that the grid ignores
  sand.parameters().cohesion = 0.0;
  sand.parameters().void_ratio = 0.581;
}

void BiaxialOptions::declare(options::OptionSet& options) {
  run.declare(options);
  options.section("Biaxial");
  declare_specimen(options);
  declare_loading(options);
  checks.declare(options);
  sand.declare(options);
}

void BiaxialOptions::declare_specimen(options::OptionSet& options) {
  options.real("biaxial_width", width, options::positive(),
               {"m", "of the specimen, whole cells", "chosen: the paper gives no size"});
  options.real("biaxial_height", height, options::positive(),
               {"m", "of the specimen, whole cells", "chosen: the paper gives no size"});
  options.real("cell_size", cell_size, options::positive(),
               {"m", "side of the square cells", "paper, section 3.2"});
  options.real("confining_pressure", confining_pressure, options::positive(),
               {"Pa", "on the sides, and everywhere at the start", "paper, section 3.2"});
  options.real_list("biaxial_points", points, {},
                    {"m", "x,y,x,y of two places; the particles nearest to them are watched",
                     "chosen: outside and inside the shear bands"});
}

void BiaxialOptions::declare_loading(options::OptionSet& options) {
  options.real("biaxial_velocity", velocity, options::positive(),
               {"m/s", "of the plate, downward", "paper, section 3.2"});
  options.real("biaxial_ramp_strain", ramp_strain, options::between(0.0, 1.0),
               {"1", "axial strain over which the velocity rises as (1 - cos)/2", "chosen"});
  options.real(
      "strain_end", strain_end, {.minimum = 0.0, .maximum = 0.5, .open_minimum = true},
      {"1", "last axial strain, displacement of the plate over height", "paper, section 3.2"});
  options.real("contact_friction", friction, options::not_negative(),
               {"1", "Coulomb coefficient between sand and plate; 100 is as good as rough",
                "paper, section 3.2"});
  options.real("contact_gap_cells", gap_cells, {.minimum = 0.0, .maximum = 2.0},
               {"cells", "largest distance of a touching node from the plate", "docs/model.md"});
  options.real(
      "damping", damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
      {"1", "local damping of the consolidation only, f -= damping |f| sign(v)", "docs/model.md"});
  options.real("rest_tolerance", tolerance, {.minimum = 1e-12, .maximum = 0.1},
               {"1",
                "consolidation ends when sum |f| falls below this share of pressure times "
                "height",
                "chosen"});
}

int BiaxialOptions::cells_over(const char* name, double length) const {
  const double cells = length / cell_size;
  if (std::abs(cells - std::round(cells)) > 1e-6 * cells || cells < 2.0)
    throw BadInput(
        fmt::format("-{} {} m is {:.6g} cells of -cell_size {} m: whole numbers from 2 "
                    "on are allowed",
                    name, length, cells, cell_size));
  return static_cast<int>(std::round(cells));
}

solver::SimulationSetup<2> BiaxialOptions::setup() const {
  const int across = cells_over("biaxial_width", width);
  const int up = cells_over("biaxial_height", height);
  const int margin = across / 2 + 1;  // room for bulging
  const int above = 3;                // nodes of the plate
  const double half = 0.5 * width;
  using grid::Wall;
  solver::SimulationSetup<2> setup{
      .lines = {basis::KnotLines::uniform(-half - margin * cell_size, half + margin * cell_size,
                                          across + 2 * margin),
                basis::KnotLines::uniform(0.0, (up + above) * cell_size, up + above)}};
  run.apply_to(setup);
  setup.walls = {{{Wall::free, Wall::free}, {Wall::fixed, Wall::free}}};
  setup.materials = {sand.create()};
  setup.filling = {
      [half, top = height](const Vector<2>& x) {
        return std::abs(x[0]) < half && x[1] < top ? std::optional(0) : std::nullopt;
      },
      [n = static_cast<int>(run.particles_per_cell_direction)](const auto&) { return n; }};
  return setup;
}

/// Both sides.
std::vector<particles::SurfacePiece<2>> BiaxialOptions::sides() const {
  const solver::SimulationSetup<2> specimen = setup();
  std::vector<particles::SurfacePiece<2>> pieces;
  for (const particles::Side side : {0, 1})
    for (const auto& piece : particles::surface_pieces<2>(
             specimen.lines, specimen.filling, side,
             [pressure = confining_pressure](const Vector<2>&) { return pressure; }))
      pieces.push_back(piece);
  return pieces;
}

}  // namespace mpm::cases
