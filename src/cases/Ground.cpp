#include "mpm/cases/Ground.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::cases {

template <int dim>
std::optional<int> Ground<dim>::region_at(const Vector<dim>& x) const {
  for (std::size_t k = m_regions.size(); k-- > 0;)
    if (m_regions[k].shape->locate(x).distance <= 0.0) return static_cast<int>(k);
  return std::nullopt;
}

/// The height of x and those above it at which a region begins or ends, ascending.
template <int dim>
std::vector<double> Ground<dim>::heights_above(const Vector<dim>& x) const {
  std::vector<double> heights{x[geometry::vertical<dim>]};
  for (const Region<dim>& region : m_regions)
    for (const double height : region.shape->crossings(x))
      if (height > heights.front() && std::isfinite(height)) heights.push_back(height);
  std::ranges::sort(heights);
  return heights;
}

/// Between two of these heights the column above x is of one region.
template <int dim>
double Ground<dim>::load_above(const Vector<dim>& x) const {
  constexpr int up = geometry::vertical<dim>;
  const std::vector<double> heights = heights_above(x);
  double weight = 0.0;
  Vector<dim> surface = x;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    Vector<dim> middle = x;
    middle[up] = 0.5 * (heights[k] + heights[k + 1]);
    const auto region = region_at(middle);
    if (!region) continue;
    weight +=
        m_regions[static_cast<std::size_t>(*region)].unit_weight * (heights[k + 1] - heights[k]);
    surface[up] = heights[k + 1];
  }
  return m_surcharge(surface) + weight;
}

template <int dim>
SymmetricTensor Ground<dim>::stress_at(const Vector<dim>& x) const {
  const auto found = region_at(x);
  if (!found) return {};
  const Region<dim>& region = m_regions[static_cast<std::size_t>(*found)];
  if (region.stress) return *region.stress;
  const double vertical = -load_above(x), horizontal = region.K0 * vertical;
  SymmetricTensor stress{{horizontal, horizontal, horizontal, 0.0, 0.0, 0.0}};
  stress[geometry::vertical<dim>] = vertical;
  return stress;
}

template class Ground<1>;
template class Ground<2>;
template class Ground<3>;

}  // namespace mpm::cases
