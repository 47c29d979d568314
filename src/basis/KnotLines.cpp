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

constexpr double growth = 1.05;  // of neighbouring cells

/// Distances from the origin: cells of width h up to `fine`, then growing until `ratio` h, until
/// `length` is reached; the last line may lie up to a cell beyond.
std::vector<double> distances(double h, double fine, double ratio, double length) {
  std::vector<double> lines{0.0};
  double width = h;
  while (lines.back() < length - 1e-9 * h) {
    if (lines.back() > fine - 1e-9 * h) width = std::min(width * growth, ratio * h);
    lines.push_back(lines.back() + width);
  }
  return lines;
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

KnotLines KnotLines::graded(const Graded& wanted) {
  const auto& [begin, end, fine_begin, fine_end, origin, cell, ratio] = wanted;
  const auto down = distances(cell, origin - fine_begin, ratio, origin - begin);
  const auto up = distances(cell, fine_end - origin, ratio, end - origin);
  std::vector<double> lines;
  for (auto line = down.rbegin(); line != down.rend(); ++line) lines.push_back(origin - *line);
  for (auto line = up.begin() + 1; line != up.end(); ++line) lines.push_back(origin + *line);
  return KnotLines(std::move(lines));
}

}  // namespace mpm::basis
