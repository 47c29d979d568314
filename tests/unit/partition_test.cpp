#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "mpm/core/Errors.hpp"
#include "mpm/partition/Comparison.hpp"
#include "mpm/partition/MetisBlocks.hpp"

namespace mpm::partition {
namespace {

// Layout ----------------------------------------------------------------------------------------

/// Work that grows along y, nine tenths of it in the upper third of 60 cells.
CellWork<2> top_heavy_work(const std::array<int, 2>& cells) {
  CellWork<2> work{cells, {}};
  for_each_cell<2>(cells, [&](std::size_t, const auto& cell) {
    work.work.push_back(cell[1] < 40 ? 0.05 : 0.9);
  });
  return work;
}

LayoutRequest<2> top_heavy(int ranks) {
  LayoutRequest<2> request;
  request.nodes = {43, 63};
  request.owner_offset = 1;
  request.smallest_range = 3;
  request.ranks = ranks;
  request.work = top_heavy_work({40, 60});
  return request;
}

Ownership<2> ownership_of(const LayoutRequest<2>& request, const Layout<2>& layout) {
  return ownership_of<2>(layout, request.work.cells, request.owner_offset);
}

TEST(Layout, balances_the_work_and_not_the_cells) {
  for (int ranks : {1, 2, 3, 4, 6, 8}) {
    const auto request = top_heavy(ranks);
    const auto layout = balanced_layout(request);
    EXPECT_EQ(layout.processes(0) * layout.processes(1), ranks);
    EXPECT_LT(imbalance(request.work, ownership_of(request, layout), ranks), 1.1) << ranks;
    for (int d : {0, 1}) {
      EXPECT_EQ(layout.starts[d].front(), 0);
      EXPECT_EQ(layout.starts[d].back(), request.nodes[d]);
      for (std::size_t k = 1; k < layout.starts[d].size(); ++k)
        EXPECT_GE(layout.starts[d][k] - layout.starts[d][k - 1], request.smallest_range);
    }
  }
}

TEST(Layout, imbalance_is_the_largest_load_over_the_mean) {
  auto request = top_heavy(2);
  Layout<2> halves;
  halves.starts = {{{0, 43}, {0, 31, 63}}};  // 30 rows of cells each
  const double lower = 30 * 0.05, upper = 10 * 0.05 + 20 * 0.9;
  EXPECT_NEAR(imbalance(request.work, ownership_of(request, halves), 2),
              upper / (0.5 * (lower + upper)), 1e-12);
}

TEST(Layout, one_direction_is_cut_where_only_it_is_long) {
  auto request = top_heavy(4);
  request.nodes = {5, 63};
  request.work = top_heavy_work({2, 60});
  EXPECT_EQ(balanced_layout(request).processes(1), 4);
}

TEST(Layout, too_many_ranks_are_refused_with_the_largest_count_that_works) {
  auto request = top_heavy(9);
  request.nodes = {7, 12};  // at most 2 x 4 ranks
  request.work = top_heavy_work({4, 9});
  try {
    balanced_layout(request);
    FAIL() << "nothing was thrown";
  } catch (const BadInput& error) {
    EXPECT_NE(std::string(error.what()).find("9 ranks"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("works is 8"), std::string::npos) << error.what();
  }
}

// Blocks ----------------------------------------------------------------------------------------

/// Four particles in every cell between two circles about a point.
CellWork<2> ring(const std::array<int, 2>& cells, double centre_x) {
  CellWork<2> work{cells, {}};
  for_each_cell<2>(cells, [&](std::size_t, const auto& cell) {
    const double r = std::hypot(cell[0] + 0.5 - centre_x, cell[1] + 0.5 - 0.5 * cells[1]);
    work.work.push_back(r > 17.0 && r < 29.0 ? 4.0 : 0.0);
  });
  return work;
}

Ownership<2> all_to_first(const std::array<int, 2>& cells) {
  return {{{{0, cells[0]}, {0, cells[1]}}}, {0}};
}

Ownership<2> metis_blocks_of(const CellWork<2>& work, int ranks) {
  return metis_blocks(work, ranks, all_to_first(work.cells));
}

TEST(Ownership, of_a_cell_is_that_of_its_block) {
  const Ownership<2> ownership({{{0, 3, 7}, {0, 2, 4, 9}}}, {5, 1, 4, 2, 3, 0});
  EXPECT_EQ(ownership.rank_of({2, 1}), 5);
  EXPECT_EQ(ownership.rank_of({3, 1}), 1);
  EXPECT_EQ(ownership.rank_of({0, 2}), 4);
  EXPECT_EQ(ownership.rank_of({6, 8}), 0);
  EXPECT_EQ(ownership.cells(), (std::array{7, 9}));
}

TEST(Ownership, of_ranges_is_that_of_their_nodes) {
  const Layout<1> layout{{{{0, 3, 8, 13}}}};  // 13 nodes of 10 cells, the first before them all
  const Ownership<1> ownership = ownership_of<1>(layout, {10}, 1);
  for (int cell = 0; cell < 10; ++cell)
    EXPECT_EQ(ownership.rank_of({cell}), cell + 1 < 3 ? 0 : cell + 1 < 8 ? 1 : 2) << cell;
}

TEST(Ownership, metis_blocks_balance_a_ring) {
  const CellWork<2> work = ring({71, 66}, 33.0);
  for (int ranks : {1, 2, 3, 4, 8, 13, 16})
    EXPECT_LT(imbalance(work, metis_blocks_of(work, ranks), ranks), 1.06) << ranks;
}

TEST(Ownership, metis_blocks_are_the_same_every_time) {
  const CellWork<2> work = ring({71, 66}, 33.0);
  EXPECT_EQ(metis_blocks_of(work, 7), metis_blocks_of(work, 7));
}

TEST(Ownership, metis_blocks_serve_more_ranks_than_there_are_blocks) {
  for (int cells : {1, 3, 5, 9, 20})
    for (int ranks : {2, 3, 4, 7, 9}) {
      const CellWork<1> work{{cells}, std::vector<double>(static_cast<std::size_t>(cells), 2.0)};
      const Ownership<1> ownership = metis_blocks(work, ranks, Ownership<1>({{{0, cells}}}, {0}));
      for (double load : loads(work, ownership, ranks)) EXPECT_LE(load, 2.0 * cells);
      for (int rank : ownership.ranks()) EXPECT_TRUE(rank >= 0 && rank < ranks) << rank;
    }
}

/// What is mirrored at a wall folds onto the second cell from it at the most.
TEST(Ownership, metis_blocks_leave_the_cells_at_a_wall_to_one_rank) {
  for (int cells : {5, 6, 7, 30, 31}) {
    const CellWork<2> work{{cells, 33},
                           std::vector<double>(static_cast<std::size_t>(cells * 33), 1)};
    const Ownership<2> ownership = metis_blocks_of(work, 9);
    for (int j = 0; j < 33; ++j) {
      EXPECT_EQ(ownership.rank_of({0, j}), ownership.rank_of({1, j}));
      EXPECT_EQ(ownership.rank_of({cells - 1, j}), ownership.rank_of({cells - 2, j}));
    }
    for (int i = 0; i < cells; ++i) {
      EXPECT_EQ(ownership.rank_of({i, 0}), ownership.rank_of({i, 1}));
      EXPECT_EQ(ownership.rank_of({i, 32}), ownership.rank_of({i, 31}));
    }
  }
}

/// Share of the work that has another owner in `after` than in `before`.
double share_moved(const CellWork<2>& work, const Ownership<2>& before, const Ownership<2>& after) {
  double moved = 0.0, total = 0.0;
  for_each_cell<2>(work.cells, [&](std::size_t k, const auto& cell) {
    total += work.work[k];
    if (before.rank_of(cell) != after.rank_of(cell)) moved += work.work[k];
  });
  return moved / total;
}

TEST(Ownership, metis_parts_keep_the_ranks_that_had_most_of_their_work) {
  const CellWork<2> work = ring({71, 66}, 33.0);
  const Ownership<2> before = metis_blocks_of(work, 8);
  EXPECT_EQ(metis_blocks(work, 8, before), before);
  std::vector<int> others = before.ranks();
  for (int& rank : others) rank = (rank + 3) % 8;
  const Ownership<2> renamed({before.starts(0), before.starts(1)}, others);
  EXPECT_EQ(metis_blocks(work, 8, renamed), renamed);
  EXPECT_LT(share_moved(work, before, metis_blocks(ring({71, 66}, 35.0), 8, before)), 0.7);
}

TEST(Ownership, three_dimensional_blocks_balance_a_layer_that_slopes) {
  CellWork<3> work{{24, 20, 22}, {}};
  for_each_cell<3>(work.cells, [&](std::size_t, const auto& cell) {
    work.work.push_back(3 * cell[2] < 20 + cell[0] - cell[1] ? 8.0 : 0.0);
  });
  const Ownership<3> first({{{0, 24}, {0, 20}, {0, 22}}}, {0});
  EXPECT_LT(imbalance(work, metis_blocks(work, 8, first), 8), 1.06);
}

TEST(Comparison, blocks_beat_balanced_ranges_and_these_beat_uniform_ones_on_a_ring) {
  const LayoutRequest<2> request{{74, 69}, 1, 3, 12, ring({71, 66}, 26.0)};
  const Imbalances found = compare(request);
  EXPECT_GT(found.uniform_ranges, 1.05 * found.balanced_ranges) << found.balanced_ranges;
  EXPECT_GT(found.balanced_ranges, 1.05 * found.metis_blocks) << found.metis_blocks;
  EXPECT_GE(found.metis_blocks, 1.0);
}

}  // namespace
}  // namespace mpm::partition
