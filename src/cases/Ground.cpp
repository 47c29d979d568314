#include "mpm/cases/Ground.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::cases {

namespace {

/// The tensor with one value along a unit vector and another one in all directions across it.
template <int dim>
SymmetricTensor along_and_across(const Vector<dim>& unit, double along, double across) {
  SymmetricTensor tensor{{across, across, across, 0.0, 0.0, 0.0}};
  for (int d = 0; d < dim; ++d)
    tensor[d] = along * unit[d] * unit[d] + across * (1.0 - unit[d] * unit[d]);
  for (int d = 0; d + 1 < dim; ++d) tensor[3 + d] = (along - across) * unit[d] * unit[d + 1];
  if constexpr (dim == 3) tensor[5] = (along - across) * unit[0] * unit[2];
  return tensor;
}

}  // namespace

template <int dim>
std::optional<int> Ground<dim>::region_at(const Vector<dim>& x) const {
  for (std::size_t k = m_regions.size(); k-- > 0;)
    if (m_regions[k].shape->locate(x).distance <= 0.0) return static_cast<int>(k);
  return std::nullopt;
}

template <int dim>
Vector<dim> Ground<dim>::raised(Vector<dim> x, double by) const {
  for (int d = 0; d < dim; ++d) x[d] += by * m_up[d];
  return x;
}

/// 0 and the heights above x at which a region begins or ends, ascending.
template <int dim>
std::vector<double> Ground<dim>::heights_above(const Vector<dim>& x) const {
  std::vector<double> heights{0.0};
  for (const Region<dim>& region : m_regions)
    for (const double height : region.shape->crossings(x, m_up))
      if (height > 0.0 && std::isfinite(height)) heights.push_back(height);
  std::ranges::sort(heights);
  return heights;
}

/// Between two of these heights the column above x is of one region.
template <int dim>
double Ground<dim>::load_above(const Vector<dim>& x) const {
  const std::vector<double> heights = heights_above(x);
  double weight = 0.0;
  Vector<dim> surface = x;
  for (std::size_t k = 0; k + 1 < heights.size(); ++k) {
    const auto region = region_at(raised(x, 0.5 * (heights[k] + heights[k + 1])));
    if (!region) continue;
    weight +=
        m_regions[static_cast<std::size_t>(*region)].unit_weight * (heights[k + 1] - heights[k]);
    surface = raised(x, heights[k + 1]);
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
  return along_and_across<dim>(m_up, vertical, horizontal);
}

template class Ground<1>;
template class Ground<2>;
template class Ground<3>;

}  // namespace mpm::cases
