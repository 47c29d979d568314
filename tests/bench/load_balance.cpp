#include <fmt/format.h>

#include <iostream>
#include <limits>
#include <string>

#include "mpm/core/Errors.hpp"
#include "mpm/partition/Comparison.hpp"

// How evenly ways to share out cells load so many ranks, from the particles in every cell: reads
// "scene moment cells_x cells_y" and the counts, x fastest, as often as they come; prints CSV.

namespace mpm {
namespace {

constexpr double not_possible = std::numeric_limits<double>::quiet_NaN();

partition::CellWork<2> read_counts(std::istream& in) {
  partition::CellWork<2> counts;
  in >> counts.cells[0] >> counts.cells[1];
  counts.work.resize(static_cast<std::size_t>(counts.cells[0] * counts.cells[1]));
  for (double& count : counts.work) in >> count;
  return counts;
}

partition::Imbalances compare(const partition::CellWork<2>& counts, int ranks) {
  partition::LayoutRequest<2> request;  // of cubic splines
  for (int d = 0; d < 2; ++d) request.nodes[d] = counts.cells[d] + 3;
  request.owner_offset = 1;
  request.smallest_range = 3;
  request.ranks = ranks;
  request.work = counts;
  try {
    return partition::compare(request);
  } catch (const BadInput&) {
    return {not_possible, not_possible, not_possible};
  }
}

void measure(std::istream& in) {
  fmt::print("scene,moment,ranks,method,max_over_mean\n");
  for (std::string scene, moment; in >> scene >> moment;) {
    const partition::CellWork<2> counts = read_counts(in);
    for (int ranks : {4, 8, 64}) {
      const partition::Imbalances found = compare(counts, ranks);
      const auto print = [&](const char* method, double value) {
        fmt::print("{},{},{},{},{:.3f}\n", scene, moment, ranks, method, value);
      };
      print("uniform_ranges", found.uniform_ranges);
      print("balanced_ranges", found.balanced_ranges);
      print("metis_blocks", found.metis_blocks);
    }
  }
}

}  // namespace
}  // namespace mpm

int main() {
  mpm::measure(std::cin);
}
