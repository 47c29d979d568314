#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace mpm::partition {

/// Work in every cell of a grid, e.g. its number of particles, first direction fastest.
template <int dim>
struct CellWork {
  std::array<int, dim> cells;
  std::vector<double> work;
};

/// Who computes what: the cells of a grid in blocks, each of which is a rank's.
template <int dim>
class Ownership {
 public:
  /// `starts` per direction: first cell of each block and, last, the number of cells. `ranks` of
  /// the blocks, first direction fastest.
  Ownership(std::array<std::vector<int>, dim> starts, std::vector<int> ranks);

  int rank_of(const std::array<int, dim>& cell) const {
    std::size_t block = 0;
    for (int d = 0; d < dim; ++d) block += m_block_of[d][static_cast<std::size_t>(cell[d])];
    return m_ranks[block];
  }
  std::array<int, dim> cells() const;
  const std::vector<int>& starts(int d) const { return m_starts[d]; }
  int blocks(int d) const { return static_cast<int>(m_starts[d].size()) - 1; }
  const std::vector<int>& ranks() const { return m_ranks; }

  bool operator==(const Ownership&) const = default;

 private:
  std::array<std::vector<int>, dim> m_starts;
  std::vector<int> m_ranks;
  std::array<std::vector<std::size_t>, dim> m_block_of;  ///< a cell's share of the block's index
};

/// Work of every rank.
template <int dim>
std::vector<double> loads(const CellWork<dim>& work, const Ownership<dim>& ownership, int ranks);

/// Largest load of a rank over the mean load.
template <int dim>
double imbalance(const CellWork<dim>& work, const Ownership<dim>& ownership, int ranks);

/// Visits all cells, first direction fastest: visit(number of the cell, cell).
template <int dim, class Visit>
void for_each_cell(const std::array<int, dim>& cells, const Visit& visit) {
  std::array<int, dim> cell{};
  for (std::size_t k = 0;; ++k) {
    visit(k, cell);
    int d = 0;
    while (d < dim && ++cell[d] == cells[d]) cell[d++] = 0;
    if (d == dim) return;
  }
}

extern template class Ownership<1>;
extern template class Ownership<2>;
extern template class Ownership<3>;

}  // namespace mpm::partition
