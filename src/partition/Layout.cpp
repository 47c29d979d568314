#include "mpm/partition/Layout.hpp"

#include <fmt/format.h>

#include <numeric>
#include <optional>

#include "mpm/core/Errors.hpp"

namespace mpm::partition {
namespace {

/// Load of each node of a direction: that of the cells it brings to its owner.
template <int dim>
std::array<std::vector<double>, dim> marginal_loads(const LayoutRequest<dim>& request) {
  std::array<std::vector<double>, dim> loads;
  for (int d = 0; d < dim; ++d) loads[d].assign(request.nodes[d], 0.0);
  for_each_cell<dim>(request.work.cells, [&](std::size_t k, const std::array<int, dim>& cell) {
    for (int d = 0; d < dim; ++d)
      loads[d][static_cast<std::size_t>(cell[d] + request.owner_offset)] += request.work.work[k];
  });
  return loads;
}

/// Cuts a line of loads into parts of equal sums, none shorter than `smallest`.
std::vector<int> cut(const std::vector<double>& loads, int parts, int smallest) {
  const int n = static_cast<int>(loads.size());
  const double total = std::accumulate(loads.begin(), loads.end(), 0.0);
  std::vector<int> starts{0};
  double sum = 0.0;
  int node = 0;
  for (int part = 1; part < parts; ++part) {
    const double target = total * part / parts;
    while (node < n && sum + 0.5 * loads[static_cast<std::size_t>(node)] < target)
      sum += loads[static_cast<std::size_t>(node++)];
    const int lowest = starts.back() + smallest, highest = n - smallest * (parts - part);
    starts.push_back(std::clamp(node, lowest, highest));
  }
  starts.push_back(n);
  return starts;
}

/// Visits every way to write `ranks` as a product of `dim` factors that the grid can hold.
template <int dim, class Visit>
void for_each_shape(const LayoutRequest<dim>& request, int ranks, const Visit& visit) {
  std::array<int, dim> shape{};
  auto choose = [&](auto&& self, int d, int rest) -> void {
    if (d == dim - 1) {
      shape[d] = rest;
      if (rest * request.smallest_range <= request.nodes[d]) visit(shape);
      return;
    }
    for (int factor = 1; factor <= rest; ++factor)
      if (rest % factor == 0 && factor * request.smallest_range <= request.nodes[d]) {
        shape[d] = factor;
        self(self, d + 1, rest / factor);
      }
  };
  choose(choose, 0, ranks);
}

template <int dim>
int largest_rank_count(const LayoutRequest<dim>& request) {
  for (int ranks = request.ranks - 1; ranks > 1; --ranks) {
    bool works = false;
    for_each_shape<dim>(request, ranks, [&](const auto&) { works = true; });
    if (works) return ranks;
  }
  return 1;
}

}  // namespace

template <int dim>
Layout<dim> balanced_layout(const LayoutRequest<dim>& request) {
  const auto loads = marginal_loads(request);
  std::optional<Layout<dim>> best;
  double best_imbalance = 0.0;
  for_each_shape<dim>(request, request.ranks, [&](const std::array<int, dim>& shape) {
    Layout<dim> layout;
    for (int d = 0; d < dim; ++d)
      layout.starts[d] = cut(loads[d], shape[d], request.smallest_range);
    const double load =
        imbalance(request.work, ownership_of<dim>(layout, request.work.cells, request.owner_offset),
                  request.ranks);
    if (best && load >= best_imbalance * (1.0 - 1e-9)) return;
    best = layout;
    best_imbalance = load;
  });
  if (!best)
    throw BadInput(
        fmt::format("{} ranks are too many for this grid: each needs {} nodes in every "
                    "direction; the largest count that works is {}",
                    request.ranks, request.smallest_range, largest_rank_count(request)));
  return *best;
}

template <int dim>
Layout<dim> uniform_layout(LayoutRequest<dim> request) {
  std::ranges::fill(request.work.work, 1.0);
  return balanced_layout(request);
}

template <int dim>
Ownership<dim> ownership_of(const Layout<dim>& layout, const std::array<int, dim>& cells,
                            int owner_offset) {
  std::array<std::vector<int>, dim> starts;
  int processes = 1;
  for (int d = 0; d < dim; ++d) {
    processes *= layout.processes(d);
    for (int node : layout.starts[d])
      starts[d].push_back(std::clamp(node - owner_offset, 0, cells[d]));
    starts[d].back() = cells[d];
  }
  std::vector<int> ranks(static_cast<std::size_t>(processes));
  std::iota(ranks.begin(), ranks.end(), 0);
  return {std::move(starts), std::move(ranks)};
}

#define MPM_INSTANTIATE(dim)                                       \
  template struct Layout<dim>;                                     \
  template Layout<dim> balanced_layout(const LayoutRequest<dim>&); \
  template Layout<dim> uniform_layout(LayoutRequest<dim>);         \
  template Ownership<dim> ownership_of<dim>(const Layout<dim>&, const std::array<int, dim>&, int)
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::partition
