#include "mpm/basis/Gimp.hpp"

#include <algorithm>
#include <utility>

#include "NodesOnLines.hpp"

namespace mpm::basis {

Gimp::Gimp(KnotLines lines, int particles_per_cell) : m_lines(std::move(lines)) {
  const std::vector<double> widths = mirrored_widths(m_lines, 2, "uGIMP");
  double middle = m_lines.begin() - widths[1];
  for (std::size_t a = 0; a < static_cast<std::size_t>(count()); ++a) {
    m_hats.push_back({middle, widths[a], widths[a + 1]});
    middle += widths[a + 1];
  }
  for (std::size_t cell = 0; cell + 4 < widths.size(); ++cell) {
    const double width = widths[cell + 2];
    const double smallest_neighbour = std::min(widths[cell + 1], widths[cell + 3]);
    m_half_extent.push_back(std::min(0.5 * width / particles_per_cell, 0.5 * smallest_neighbour));
    m_smallest_span.push_back(std::min(width, smallest_neighbour));
  }
}

NodeLine Gimp::nodes() const {
  return nodes_on_lines(m_lines, "uGIMP");
}

}  // namespace mpm::basis
