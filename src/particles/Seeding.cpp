#include "mpm/particles/Seeding.hpp"

#include <fmt/format.h>

#include <cmath>

#include "mpm/core/Errors.hpp"

namespace mpm::particles {
namespace {

struct Point {
  double xi;      ///< in [0, 1]
  double weight;  ///< share of the cell
};

std::vector<Point> gauss_points(int n) {
  if (n == 1) return {{0.5, 1.0}};
  if (n == 2) return {{0.5 - std::sqrt(1.0 / 12), 0.5}, {0.5 + std::sqrt(1.0 / 12), 0.5}};
  if (n == 3)
    return {{0.5 - std::sqrt(0.15), 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + std::sqrt(0.15), 5.0 / 18}};
  throw BadInput(
      fmt::format("{} particles per direction at Gauss points: 1, 2 or 3 are possible", n));
}

std::vector<Point> points(int n, Placement placement) {
  if (placement == Placement::gauss) return gauss_points(n);
  std::vector<Point> middles;
  for (int k = 0; k < n; ++k) middles.push_back({(k + 0.5) / n, 1.0 / n});
  return middles;
}

constexpr std::int64_t ids_per_cell = 4096;  // room for 16 x 16 x 16 particles

}  // namespace

template <int dim>
std::vector<Seed<dim>> seeds_of_cell(const std::array<basis::KnotLines, dim>& lines,
                                     const std::array<int, dim>& cell,
                                     const Filling<dim>& filling) {
  Vector<dim> centre;
  std::int64_t cell_id = 0;
  for (int d = dim - 1; d >= 0; --d) {
    centre[d] = 0.5 * (lines[d].line(cell[d]) + lines[d].line(cell[d] + 1));
    cell_id = cell_id * lines[d].cells() + cell[d];
  }
  const int n = filling.per_direction(centre);
  const std::vector<Point> rule = points(n, filling.placement);
  int count = 1;
  for (int d = 0; d < dim; ++d) count *= n;

  std::vector<Seed<dim>> seeds;
  for (int k = 0; k < count; ++k) {
    Seed<dim> seed;
    seed.id = cell_id * ids_per_cell + k;
    seed.volume = 1.0;
    for (int d = 0, rest = k; d < dim; ++d, rest /= n) {
      const Point& point = rule[static_cast<std::size_t>(rest % n)];
      seed.position[d] = lines[d].line(cell[d]) + point.xi * lines[d].width(cell[d]);
      seed.volume *= point.weight * lines[d].width(cell[d]);
    }
    if (const auto material = filling.material_at(seed.position)) {
      seed.material = *material;
      seeds.push_back(seed);
    }
  }
  return seeds;
}

#define MPM_INSTANTIATE(dim)                          \
  template std::vector<Seed<dim>> seeds_of_cell<dim>( \
      const std::array<basis::KnotLines, dim>&, const std::array<int, dim>&, const Filling<dim>&)
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::particles
