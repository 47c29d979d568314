#include "Ways.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "Lists.hpp"

namespace mpm::cases::custom {
namespace {

double size_of(const std::vector<double>& v) {
  double square = 0.0;
  for (const double component : v) square += component * component;
  return std::sqrt(square);
}

/// How far a body goes in a stage, m; 0 where only the run can tell.
double way_in(const StageOptions& stage, const BodyOptions& body, const CustomOptions& options) {
  if (stage.is_settling() || stage.bodies == Bodies::held) return 0.0;
  const std::size_t colon = stage.until.find(':');
  const double speed = size_of(body.velocity);
  if (colon == std::string::npos) return speed * std::strtod(stage.until.c_str(), nullptr);
  const double distance = std::strtod(stage.until.c_str() + colon + 1, nullptr);
  const auto leader = std::ranges::find(options.bodies, stage.until.substr(0, colon),
                                        [](const auto& other) { return other->name; });
  if (leader == options.bodies.end() || (*leader)->velocity.empty()) return 0.0;
  return distance * speed / size_of((*leader)->velocity);
}

template <int dim>
Vector<dim> end_of_way(const BodyOptions& options, const Vector<dim>& start, double way) {
  const double speed = size_of(options.velocity);
  Vector<dim> end = start;
  for (std::size_t d = 0; d < dim; ++d) end[d] += options.velocity[d] / speed * way;
  return end;
}

/// Whether the body's shape is at a wall when its reference point is there.
template <int dim>
bool touches(const Body<dim>& body, const Vector<dim>& reference, std::size_t d, double wall) {
  Vector<dim> seen = body.rigid->position;  // the wall as the body sees it from where it is now
  seen[d] += wall - reference[d];
  return body.rigid->locate(seen).distance <= 0.0;
}

}  // namespace

template <int dim>
void check_ways(const CustomOptions& options, const std::vector<Body<dim>>& bodies,
                const std::array<basis::KnotLines, dim>& lines,
                const typename grid::Walls<dim>::Kinds& walls) {
  if (options.run.end_time || options.run.max_steps > 0) return;  // these end it earlier
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodyOptions& given = *options.bodies[k];
    if (!bodies[k].moves || given.velocity.empty()) continue;
    double way = 0.0;
    for (const auto& stage : options.stages) way += way_in(*stage, given, options);
    const Vector<dim> end = end_of_way<dim>(given, bodies[k].start, way);
    for (std::size_t side = 0; side < 2 * dim; ++side) {
      const std::size_t d = side / 2;
      const double wall = side % 2 == 0 ? lines[d].begin() : lines[d].end();
      if (walls[d][side % 2] == grid::Wall::free) continue;
      if (touches<dim>(bodies[k], bodies[k].start, d, wall) ||
          !touches<dim>(bodies[k], end, d, wall))
        continue;
      throw BadInput(fmt::format(
          "-body_{0}_velocity {1}: by the end of the stages {0} has gone {2:.4g} m, into the {3} "
          "wall at {4}; a shorter stage or a larger -domain is needed",
          given.name, fmt::join(given.velocity, ","), way, side_names[side], wall));
    }
  }
}

template void check_ways<1>(const CustomOptions&, const std::vector<Body<1>>&,
                            const std::array<basis::KnotLines, 1>&, const grid::Walls<1>::Kinds&);
template void check_ways<2>(const CustomOptions&, const std::vector<Body<2>>&,
                            const std::array<basis::KnotLines, 2>&, const grid::Walls<2>::Kinds&);
template void check_ways<3>(const CustomOptions&, const std::vector<Body<3>>&,
                            const std::array<basis::KnotLines, 3>&, const grid::Walls<3>::Kinds&);

}  // namespace mpm::cases::custom
