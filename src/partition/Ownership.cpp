#include "mpm/partition/Ownership.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace mpm::partition {

template <int dim>
Ownership<dim>::Ownership(std::array<std::vector<int>, dim> starts, std::vector<int> ranks)
    : m_starts(std::move(starts)), m_ranks(std::move(ranks)) {
  std::size_t stride = 1;
  for (int d = 0; d < dim; ++d) {
    for (std::size_t block = 0; block + 1 < m_starts[d].size(); ++block)
      m_block_of[d].resize(static_cast<std::size_t>(m_starts[d][block + 1]), block * stride);
    stride *= static_cast<std::size_t>(blocks(d));
  }
}

template <int dim>
std::array<int, dim> Ownership<dim>::cells() const {
  std::array<int, dim> cells;
  for (int d = 0; d < dim; ++d) cells[d] = m_starts[d].back();
  return cells;
}

template <int dim>
std::vector<double> loads(const CellWork<dim>& work, const Ownership<dim>& ownership, int ranks) {
  std::vector<double> load(static_cast<std::size_t>(ranks), 0.0);
  for_each_cell<dim>(work.cells, [&](std::size_t k, const std::array<int, dim>& cell) {
    load[static_cast<std::size_t>(ownership.rank_of(cell))] += work.work[k];
  });
  return load;
}

template <int dim>
double imbalance(const CellWork<dim>& work, const Ownership<dim>& ownership, int ranks) {
  const std::vector<double> load = loads(work, ownership, ranks);
  const double total = std::accumulate(load.begin(), load.end(), 0.0);
  return total == 0.0 ? 1.0 : *std::ranges::max_element(load) * ranks / total;
}

#define MPM_INSTANTIATE(dim)                                                                  \
  template class Ownership<dim>;                                                              \
  template std::vector<double> loads(const CellWork<dim>&, const Ownership<dim>&, int ranks); \
  template double imbalance(const CellWork<dim>&, const Ownership<dim>&, int ranks)
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::partition
