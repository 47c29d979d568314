#include "mpm/basis/KnotLines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mpm/core/Errors.hpp"

namespace mpm::basis {
namespace {

void check(const std::vector<double>& positions) {
  if (positions.size() < 2)
    throw BadInput(fmt::format("{} knot lines given, at least 2 are needed", positions.size()));
  for (std::size_t k = 1; k < positions.size(); ++k)
    if (!(positions[k] > positions[k - 1]) || !std::isfinite(positions[k]))
      throw BadInput(fmt::format("knot lines must increase: line {} is at {} m, line {} at {} m",
                                 k - 1, positions[k - 1], k, positions[k]));
}

}  // namespace

KnotLines::KnotLines(std::vector<double> positions) : m_positions(std::move(positions)) {
  check(m_positions);
  double largest = 0.0;
  m_smallest_width = end() - begin();
  for (int cell = 0; cell < cells(); ++cell) {
    m_smallest_width = std::min(m_smallest_width, width(cell));
    largest = std::max(largest, width(cell));
  }
  m_uniform = largest - m_smallest_width < 1e-9 * largest;
  const auto bins = static_cast<std::size_t>(std::ceil((end() - begin()) / m_smallest_width)) + 1;
  m_bins_per_length = static_cast<double>(bins) / (end() - begin());
  m_first_cell_of_bin.resize(bins + 1, cells() - 1);
  int cell = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    const double x = begin() + static_cast<double>(bin) / m_bins_per_length;
    while (cell + 1 < cells() && x >= line(cell + 1)) ++cell;
    m_first_cell_of_bin[bin] = cell;
  }
}

KnotLines KnotLines::uniform(double begin, double end, int cells) {
  std::vector<double> positions(static_cast<std::size_t>(cells) + 1);
  for (int k = 0; k <= cells; ++k)
    positions[static_cast<std::size_t>(k)] = begin + (end - begin) * k / cells;
  return KnotLines(std::move(positions));
}

}  // namespace mpm::basis
