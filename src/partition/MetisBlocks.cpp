#include "mpm/partition/MetisBlocks.hpp"

#include <fmt/format.h>
#include <metis.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace mpm::partition {
namespace {

constexpr int largest_edge = 4, smallest_edge = 2;  // cells of a block
constexpr double largest_share = 0.05;              // of a rank's work in one block
constexpr double good_enough = 1.02;                // largest over mean load
constexpr int seeds = 3;                            // of METIS' random numbers

/// Blocks of `edge` cells; the last one takes what is left.
std::vector<int> block_starts(int cells, int edge) {
  std::vector<int> starts;
  for (int k = 0; k < std::max(1, cells / edge); ++k) starts.push_back(k * edge);
  starts.push_back(cells);
  return starts;
}

/// Blocks of which each is the only one of its rank: their loads are the work in them.
template <int dim>
Ownership<dim> numbered_blocks(const std::array<int, dim>& cells, int edge) {
  std::array<std::vector<int>, dim> starts;
  std::size_t count = 1;
  for (int d = 0; d < dim; ++d) {
    starts[d] = block_starts(cells[d], edge);
    count *= starts[d].size() - 1;
  }
  std::vector<int> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0);
  return {std::move(starts), std::move(numbers)};
}

template <int dim>
std::vector<double> work_of_blocks(const CellWork<dim>& work, const Ownership<dim>& blocks) {
  return loads(work, blocks, static_cast<int>(blocks.ranks().size()));
}

template <int dim>
Ownership<dim> fine_enough_blocks(const CellWork<dim>& work, int ranks) {
  const double mean = std::accumulate(work.work.begin(), work.work.end(), 0.0) / ranks;
  for (int edge = largest_edge;; --edge) {
    Ownership<dim> blocks = numbered_blocks<dim>(work.cells, edge);
    if (edge == smallest_edge ||
        std::ranges::max(work_of_blocks(work, blocks)) <= largest_share * mean)
      return blocks;
  }
}

/// The blocks and the faces between them, as METIS wants to see them.
struct Graph {
  std::vector<idx_t> first_edge{0}, neighbour, face, weight;

  idx_t size() const { return static_cast<idx_t>(weight.size()); }
};

template <int dim>
idx_t cells_of_face(const Ownership<dim>& blocks, const std::array<int, dim>& block, int normal) {
  idx_t cells = 1;
  for (int d = 0; d < dim; ++d) {
    const auto k = static_cast<std::size_t>(block[d]);
    if (d != normal) cells *= blocks.starts(d)[k + 1] - blocks.starts(d)[k];
  }
  return cells;
}

/// METIS weighs by integers: the heaviest graph stays within their range.
std::vector<idx_t> integer_weights(const std::vector<double>& work) {
  const double total = std::accumulate(work.begin(), work.end(), 0.0);
  const double scale = total > 0.0 ? std::min(10.0, 1e9 / total) : 1.0;
  std::vector<idx_t> weights;
  for (double value : work)
    weights.push_back(std::max<idx_t>(1, static_cast<idx_t>(std::lround(scale * value))));
  return weights;
}

template <int dim>
Graph graph_of(const Ownership<dim>& blocks, const std::vector<double>& work) {
  Graph graph;
  graph.weight = integer_weights(work);
  std::array<int, dim> counts;
  for (int d = 0; d < dim; ++d) counts[d] = blocks.blocks(d);
  for_each_cell<dim>(counts, [&](std::size_t k, const std::array<int, dim>& block) {
    int stride = 1;
    for (int d = 0; d < dim; stride *= counts[d++])
      for (int side : {-1, 1}) {
        if (block[d] + side < 0 || block[d] + side == counts[d]) continue;
        graph.neighbour.push_back(static_cast<idx_t>(k) + side * stride);
        graph.face.push_back(cells_of_face<dim>(blocks, block, d));
      }
    graph.first_edge.push_back(static_cast<idx_t>(graph.neighbour.size()));
  });
  return graph;
}

enum class Method { contiguous, scattered, bisected };

std::vector<int> parts_of(Graph& graph, int ranks, Method method, int seed) {
  std::array<idx_t, METIS_NOPTIONS> options;
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = seed;
  options[METIS_OPTION_NCUTS] = 4;
  options[METIS_OPTION_UFACTOR] = 10;  // loads may differ by 1 %
  options[METIS_OPTION_CONTIG] = method == Method::contiguous ? 1 : 0;
  idx_t vertices = graph.size(), constraints = 1, parts = ranks, cut = 0;
  std::vector<idx_t> part(graph.weight.size(), 0);
  const auto partition =
      method == Method::bisected ? METIS_PartGraphRecursive : METIS_PartGraphKway;
  const int status = partition(
      &vertices, &constraints, graph.first_edge.data(), graph.neighbour.data(), graph.weight.data(),
      nullptr, graph.face.data(), &parts, nullptr, nullptr, options.data(), &cut, part.data());
  if (status != METIS_OK) throw std::runtime_error(fmt::format("METIS returned {}", status));
  return {part.begin(), part.end()};
}

std::vector<double> loads_of(const std::vector<double>& work, const std::vector<int>& parts,
                             int ranks) {
  std::vector<double> load(static_cast<std::size_t>(ranks), 0.0);
  for (std::size_t block = 0; block < work.size(); ++block)
    load[static_cast<std::size_t>(parts[block])] += work[block];
  return load;
}

double imbalance_of(const std::vector<double>& load) {
  const double total = std::accumulate(load.begin(), load.end(), 0.0);
  return total > 0.0 ? std::ranges::max(load) * static_cast<double>(load.size()) / total : 1.0;
}

/// A block of the most loaded part that a neighbouring part could take, and how far the load of
/// both would then be below that of the first.
struct Handover {
  std::size_t block = 0;
  int to = 0;
  double gain = 0.0;
};

Handover best_handover(const Graph& graph, const std::vector<double>& work,
                       const std::vector<int>& parts, const std::vector<double>& load) {
  const auto heaviest = static_cast<int>(std::ranges::max_element(load) - load.begin());
  const double most = load[static_cast<std::size_t>(heaviest)];
  Handover best;
  for (std::size_t block = 0; block < work.size(); ++block) {
    if (parts[block] != heaviest) continue;
    for (idx_t e = graph.first_edge[block]; e < graph.first_edge[block + 1]; ++e) {
      const int other =
          parts[static_cast<std::size_t>(graph.neighbour[static_cast<std::size_t>(e)])];
      const double taken = load[static_cast<std::size_t>(other)] + work[block];
      const double gain = other == heaviest ? 0.0 : std::min(work[block], most - taken);
      if (gain > best.gain) best = {block, other, gain};
    }
  }
  return best;
}

/// METIS stops a few blocks short of what is possible: these change hands one by one.
void even_out(const Graph& graph, const std::vector<double>& work, std::vector<int>& parts,
              int ranks) {
  std::vector<double> load = loads_of(work, parts, ranks);
  const double least_gain = 1e-9 * std::accumulate(load.begin(), load.end(), 0.0);
  for (std::size_t k = 0; k < work.size(); ++k) {
    const Handover handover = best_handover(graph, work, parts, load);
    if (handover.gain <= least_gain) return;
    load[static_cast<std::size_t>(parts[handover.block])] -= work[handover.block];
    load[static_cast<std::size_t>(handover.to)] += work[handover.block];
    parts[handover.block] = handover.to;
  }
}

/// In one piece each if that can be balanced.
std::vector<int> balanced_parts(Graph graph, const std::vector<double>& work, int ranks) {
  std::vector<int> best(work.size(), 0);
  if (ranks == 1) return best;
  if (work.size() <= static_cast<std::size_t>(ranks)) {  // one each, more than METIS would give
    std::iota(best.begin(), best.end(), 0);
    return best;
  }
  double smallest = ranks + 1.0;
  for (const Method method : {Method::contiguous, Method::scattered, Method::bisected})
    for (int seed = 1; seed <= seeds; ++seed) {
      std::vector<int> parts = parts_of(graph, ranks, method, seed);
      even_out(graph, work, parts, ranks);
      const double load = imbalance_of(loads_of(work, parts, ranks));
      if (load < smallest) best = std::move(parts), smallest = load;
      if (smallest < good_enough) return best;
    }
  return best;
}

/// Rank of every part: pairs with much common work first.
template <int dim>
std::vector<int> ranks_of_parts(const CellWork<dim>& work, const Ownership<dim>& parts,
                                const Ownership<dim>& previous, int ranks) {
  const auto count = static_cast<std::size_t>(ranks);
  std::vector<double> common(count * count, 0.0);
  for_each_cell<dim>(work.cells, [&](std::size_t k, const std::array<int, dim>& cell) {
    common[static_cast<std::size_t>(parts.rank_of(cell)) * count +
           static_cast<std::size_t>(previous.rank_of(cell))] += work.work[k];
  });
  std::vector<std::size_t> pairs(common.size());
  std::iota(pairs.begin(), pairs.end(), std::size_t{0});
  std::ranges::stable_sort(pairs, [&](auto a, auto b) { return common[a] > common[b]; });
  std::vector<int> rank_of_part(count, -1);
  std::vector<bool> taken(count, false);
  for (std::size_t pair : pairs) {
    const std::size_t part = pair / count, rank = pair % count;
    if (rank_of_part[part] >= 0 || taken[rank]) continue;
    rank_of_part[part] = static_cast<int>(rank);
    taken[rank] = true;
  }
  return rank_of_part;
}

template <int dim>
Ownership<dim> with_ranks(const Ownership<dim>& blocks, std::vector<int> ranks) {
  std::array<std::vector<int>, dim> starts;
  for (int d = 0; d < dim; ++d) starts[d] = blocks.starts(d);
  return {std::move(starts), std::move(ranks)};
}

}  // namespace

template <int dim>
Ownership<dim> metis_blocks(const CellWork<dim>& work, int ranks, const Ownership<dim>& previous) {
  const Ownership<dim> blocks = fine_enough_blocks(work, ranks);
  const std::vector<double> weight = work_of_blocks(work, blocks);
  std::vector<int> owners = balanced_parts(graph_of(blocks, weight), weight, ranks);
  const std::vector<int> rank_of_part =
      ranks_of_parts(work, with_ranks(blocks, owners), previous, ranks);
  for (int& owner : owners) owner = rank_of_part[static_cast<std::size_t>(owner)];
  return with_ranks(blocks, std::move(owners));
}

template Ownership<1> metis_blocks(const CellWork<1>&, int, const Ownership<1>&);
template Ownership<2> metis_blocks(const CellWork<2>&, int, const Ownership<2>&);
template Ownership<3> metis_blocks(const CellWork<3>&, int, const Ownership<3>&);

}  // namespace mpm::partition
