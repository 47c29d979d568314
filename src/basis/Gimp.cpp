#include "mpm/basis/Gimp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mpm/core/Errors.hpp"

namespace mpm::basis {
namespace {

/// Widths of the cells with two mirrored ones on either side.
std::vector<double> mirrored_widths(const KnotLines& lines) {
  const int n = lines.cells();
  std::vector<double> widths{lines.width(1), lines.width(0)};
  for (int cell = 0; cell < n; ++cell) widths.push_back(lines.width(cell));
  widths.push_back(lines.width(n - 1));
  widths.push_back(lines.width(n - 2));
  return widths;
}

}  // namespace

Gimp::Gimp(KnotLines lines, int particles_per_cell) : m_lines(std::move(lines)) {
  const int n = m_lines.cells();
  if (n < 2) throw BadInput(fmt::format("{} cells in a direction: uGIMP needs at least 2", n));
  const std::vector<double> widths = mirrored_widths(m_lines);
  double middle = m_lines.begin() - widths[1];
  for (std::size_t a = 0; a < static_cast<std::size_t>(count()); ++a) {
    m_hats.push_back({middle, widths[a], widths[a + 1]});
    middle += widths[a + 1];
  }
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(n); ++cell) {
    const double width = widths[cell + 2];
    const double smallest_neighbour = std::min(widths[cell + 1], widths[cell + 3]);
    m_half_extent.push_back(std::min(0.5 * width / particles_per_cell, 0.5 * smallest_neighbour));
    m_smallest_span.push_back(std::min(width, smallest_neighbour));
  }
}

NodeLine Gimp::nodes() const {
  NodeLine nodes{m_lines, {}, {}, support, 1, true};
  for (const Hat& hat : m_hats) {
    nodes.positions.push_back(hat.middle);
    nodes.cell_width.push_back(std::min(hat.left, hat.right));
  }
  return nodes;
}

}  // namespace mpm::basis
