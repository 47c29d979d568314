#include "Space.hpp"

#include <cmath>
#include <utility>

#include "mpm/options/InputFile.hpp"

namespace mpm::cases::custom {
namespace {

constexpr double largest_grid = 1e9;  // cells

basis::KnotLines lines_from_file(const std::string& option, const std::string& path) {
  std::vector<double> positions;
  for (const auto& line : options::read_number_lines(option, path))
    positions.insert(positions.end(), line.numbers.begin(), line.numbers.end());
  try {
    return basis::KnotLines(std::move(positions));
  } catch (const BadInput& error) {
    throw BadInput(fmt::format("-{} {}: {}", option, path, error.what()));
  }
}

/// Whole cells, or none.
basis::KnotLines equal_lines(double begin, double end, double cell) {
  const double cells = (end - begin) / cell;
  if (std::abs(cells - std::round(cells)) > 1e-6 * cells || cells < 1.0)
    throw BadInput(fmt::format(
        "-cell_size {} m: the domain from {} to {} m is {:.6g} cells long; make them whole, or "
        "give a -fine_box, whose far cells need not be",
        cell, begin, end, cells));
  return basis::KnotLines::uniform(begin, end, static_cast<int>(std::round(cells)));
}

/// Laid from 0 where the fine part holds it, else from its lower end.
basis::KnotLines graded_lines(double begin, double end, double fine_begin, double fine_end,
                              const CustomOptions& options) {
  if (fine_begin < begin || fine_end > end)
    throw BadInput(fmt::format("-fine_box: from {} to {} m is not within the domain, {} to {} m",
                               fine_begin, fine_end, begin, end));
  const bool holds_zero = fine_begin <= 0.0 && fine_end >= 0.0;
  return basis::KnotLines::graded({.begin = begin,
                                   .end = end,
                                   .fine_begin = fine_begin,
                                   .fine_end = fine_end,
                                   .origin = holds_zero ? 0.0 : fine_begin,
                                   .cell = *options.cell_size,
                                   .ratio = options.far_cell_ratio});
}

template <int dim>
basis::KnotLines lines_along(std::size_t d, const Corners<dim>& domain,
                             const CustomOptions& options) {
  if (!options.lines_files[d].empty())
    return lines_from_file(fmt::format("lines_{}", "xyz"[d]), options.lines_files[d]);
  if (!options.cell_size)
    throw BadInput(fmt::format("-cell_size is missing: give it, or -lines_{} FILE", "xyz"[d]));
  if ((domain.upper[d] - domain.lower[d]) / *options.cell_size >
      largest_grid * options.far_cell_ratio)
    throw BadInput(fmt::format("-cell_size {} m makes more than 1e9 cells", *options.cell_size));
  if (options.fine_box.empty())
    return equal_lines(domain.lower[d], domain.upper[d], *options.cell_size);
  const auto fine = corners_from<dim>("fine_box", options.fine_box);
  return graded_lines(domain.lower[d], domain.upper[d], fine.lower[d], fine.upper[d], options);
}

grid::Wall wall_named(const std::string& word) {
  constexpr std::array<std::pair<const char*, grid::Wall>, 4> kinds{
      {{"free", grid::Wall::free},
       {"roller", grid::Wall::roller},
       {"symmetry", grid::Wall::symmetry},
       {"fixed", grid::Wall::fixed}}};
  for (const auto& [name, kind] : kinds)
    if (word == name) return kind;
  throw BadInput(fmt::format(
      "-walls: there is no wall '{}'; allowed are free, roller, symmetry and fixed", word));
}

}  // namespace

template <int dim>
std::array<basis::KnotLines, dim> lines_of(const CustomOptions& options) {
  const auto domain = corners_from<dim>("domain", options.domain);
  auto lines = [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<basis::KnotLines, dim>{lines_along<dim>(d, domain, options)...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
  double cells = 1.0;
  for (const basis::KnotLines& direction : lines) cells *= direction.cells();
  if (cells > largest_grid)
    throw BadInput(
        fmt::format("-cell_size, -domain: {:.3g} cells; at most 1e9 are allowed", cells));
  return lines;
}

template <int dim>
typename grid::Walls<dim>::Kinds walls_of(const CustomOptions& options) {
  if (options.walls.size() != 2 * dim)
    throw BadInput(fmt::format("-walls {}: {} are given and {} needed with this -dimension: {}",
                               fmt::join(options.walls, ","), options.walls.size(), 2 * dim,
                               fmt::join(side_names.begin(), side_names.begin() + 2 * dim, ",")));
  typename grid::Walls<dim>::Kinds walls;
  for (std::size_t k = 0; k < options.walls.size(); ++k)
    walls[k / 2][k % 2] = wall_named(options.walls[k]);
  return walls;
}

#define MPM_INSTANTIATE(dim)                                                      \
  template std::array<basis::KnotLines, dim> lines_of<dim>(const CustomOptions&); \
  template grid::Walls<dim>::Kinds walls_of<dim>(const CustomOptions&)
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::cases::custom
