#include "Model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "Lists.hpp"
#include "Space.hpp"
#include "mpm/particles/SurfacePieces.hpp"

namespace mpm::cases::custom {
namespace {

template <int dim>
double smallest_width(const std::array<basis::KnotLines, dim>& lines) {
  double smallest = std::numeric_limits<double>::max();
  for (const basis::KnotLines& direction : lines)
    smallest = std::min(smallest, direction.smallest_width());
  return smallest;
}

template <int dim>
bool acts_at(const LoadOptions& load, const Vector<dim>& x) {
  const std::string option = fmt::format("load_{}_box", load.name);
  return load.box.empty() || corners_from<dim>(option, load.box).hold(x);
}

template <int dim>
std::optional<SymmetricTensor> stress_of(const RegionOptions& region) {
  if (region.stress.empty()) return std::nullopt;
  need_numbers(fmt::format("region_{}_stress", region.name), region.stress, 4);
  return SymmetricTensor{
      {region.stress[0], region.stress[1], region.stress[2], region.stress[3], 0.0, 0.0}};
}

}  // namespace

template <int dim>
Model<dim>::Model(const CustomOptions& options)
    : m_options(options),
      m_lines(lines_of<dim>(options)),
      m_walls(walls_of<dim>(options)),
      m_bodies(bodies_of<dim>(options, smallest_width<dim>(m_lines))),
      m_ground(
          make_regions(), [this](const Vector<dim>& x) { return surcharge(x); }, up()) {
  check_loads();
}

template <int dim>
std::vector<Region<dim>> Model<dim>::make_regions() {
  std::vector<Region<dim>> regions;
  for (const auto& one : m_options.regions) regions.push_back(make_region(*one));
  return regions;
}

template <int dim>
Region<dim> Model<dim>::make_region(const RegionOptions& options) {
  m_materials.push_back(options.law.create());
  return {.name = options.name,
          .shape = options.shape.create<dim>(),
          .unit_weight = m_materials.back()->initial_density() * m_options.gravity,
          .K0 = options.K0,
          .stress = stress_of<dim>(options)};
}

/// Against gravity. Exactly an axis where gravity is not turned.
template <int dim>
Vector<dim> Model<dim>::up() const {
  Vector<dim> up = geometry::upward<dim>();
  if (m_options.gravity_angle == 0.0) return up;
  const double angle = m_options.gravity_angle * std::numbers::pi / 180.0;
  if constexpr (dim > 1) {
    up[0] = -std::sin(angle);
    up[1] = std::cos(angle);
  }
  return up;
}

template <int dim>
void Model<dim>::check_loads() const {
  for (const auto& load : m_options.loads) {
    const auto is_given = [](const auto& pressure) { return pressure.has_value(); };
    if (std::ranges::none_of(load->pressure, is_given))
      throw BadInput(fmt::format("-loads: {0} has no pressure; give -load_{0}_top or another side",
                                 load->name));
    for (std::size_t side = 2 * dim; side < load->pressure.size(); ++side)
      if (load->pressure[side])
        throw BadInput(fmt::format("-load_{}_{}: there is no such side with this -dimension",
                                   load->name, side_names[side]));
    if (!load->box.empty()) corners_from<dim>(fmt::format("load_{}_box", load->name), load->box);
  }
}

template <int dim>
bool Model<dim>::is_uniform() const {
  return std::ranges::all_of(m_lines, [](const auto& lines) { return lines.is_uniform(); });
}

/// Soil fills what no body fills.
template <int dim>
std::optional<int> Model<dim>::soil_at(const Vector<dim>& x) const {
  for (const Body<dim>& body : m_bodies)
    if (body.rigid->locate(x).distance <= 0.0) return std::nullopt;
  return m_ground.region_at(x);
}

template <int dim>
particles::Filling<dim> Model<dim>::filling() const {
  const auto n = static_cast<int>(m_options.run.particles_per_cell_direction);
  return {[this](const Vector<dim>& x) { return soil_at(x); },
          [n](const Vector<dim>&) { return n; },
          is_uniform() ? particles::Placement::midpoint : particles::Placement::gauss};
}

template <int dim>
solver::SimulationSetup<dim> Model<dim>::setup() const {
  solver::SimulationSetup<dim> setup{.lines = m_lines};
  m_options.run.apply_to(setup);
  setup.walls = m_walls;
  setup.materials = m_materials;
  setup.filling = filling();
  for (const Body<dim>& body : m_bodies)
    if (contact::detection_kinds()[body.contact.detection].is_by_springs())
      setup.particle_contacts.push_back(body.contact.label);
  const Vector<dim> against = up();
  for (int d = 0; d < dim; ++d) setup.gravity[d] = 0.0 - m_options.gravity * against[d];
  return setup;
}

template <int dim>
double Model<dim>::smallest_cell() const {
  return smallest_width<dim>(m_lines);
}

template <int dim>
double Model<dim>::smallest_density() const {
  double smallest = std::numeric_limits<double>::max();
  for (const auto& law : m_materials) smallest = std::min(smallest, law->initial_density());
  return smallest;
}

/// What presses on the ground from above at a point of its surface.
template <int dim>
double Model<dim>::surcharge(const Vector<dim>& x) const {
  double sum = 0.0;
  for (const auto& load : m_options.loads)
    if (acts_at<dim>(*load, x))
      sum += load->pressure[2 * geometry::vertical<dim> + 1].value_or(0.0);
  return sum;
}

template <int dim>
std::function<SymmetricTensor(const Vector<dim>&)> Model<dim>::initial_stress() const {
  const bool has_stress = std::ranges::any_of(
      m_options.regions, [](const auto& region) { return !region->stress.empty(); });
  if (!has_stress && m_options.gravity == 0.0 && m_options.loads.empty()) return {};
  return [this](const Vector<dim>& x) { return m_ground.stress_at(x); };
}

template <int dim>
std::vector<particles::SurfacePiece<dim>> Model<dim>::loaded_surface() const {
  std::vector<particles::SurfacePiece<dim>> pieces;
  for (const auto& load : m_options.loads)
    for (std::size_t side = 0; side < 2 * dim; ++side) {
      if (!load->pressure[side]) continue;
      const auto pressure = [&](const Vector<dim>& x) {
        return acts_at<dim>(*load, x) ? *load->pressure[side] : 0.0;
      };
      const auto more = particles::surface_pieces<dim>(
          m_lines, filling(), static_cast<particles::Side>(side), pressure);
      if (more.empty())
        throw BadInput(fmt::format("-load_{}_{}: no soil has such a surface there", load->name,
                                   side_names[side]));
      pieces.insert(pieces.end(), more.begin(), more.end());
    }
  return pieces;
}

template <int dim>
void Model<dim>::check_filling(const solver::Simulation<dim>& simulation) const {
  const auto view = simulation.particles().view();
  std::vector<double> count(m_options.regions.size(), 0.0), at_wall(2 * dim, 0.0);
  for (int p = 0; p < view.count; ++p) {
    count[static_cast<std::size_t>(view.material[p])] += 1.0;
    for (std::size_t d = 0; d < dim; ++d) {
      const int cell = m_lines[d].cell_of(view.position[d][p]);
      if (cell == 0) at_wall[2 * d] += 1.0;
      if (cell == m_lines[d].cells() - 1) at_wall[2 * d + 1] += 1.0;
    }
  }
  simulation.communicator().sum(count);
  simulation.communicator().sum(at_wall);
  for (std::size_t k = 0; k < count.size(); ++k)
    if (count[k] == 0.0)
      throw BadInput(
          fmt::format("-regions: {} holds no particle; it lies beyond the grid, within a "
                      "body or under later regions, or is thinner than the particles",
                      m_options.regions[k]->name));
  for (std::size_t side = 0; side < 2 * dim; ++side)
    if (at_wall[side] > 0.0 && m_walls[side / 2][side % 2] == grid::Wall::free)
      throw BadInput(
          fmt::format("-walls: the soil reaches the {} wall, which is free; make it a "
                      "roller or the domain larger",
                      side_names[side]));
}

template class Model<1>;
template class Model<2>;
template class Model<3>;

}  // namespace mpm::cases::custom
