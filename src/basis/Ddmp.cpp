#include "mpm/basis/Ddmp.hpp"

#include <utility>

#include "NodesOnLines.hpp"

namespace mpm::basis {

Ddmp::Ddmp(KnotLines lines) : m_lines(std::move(lines)) {
  const std::vector<double> widths = mirrored_widths(m_lines, 2, "DDMP");
  for (std::size_t cell = 0; cell + 4 < widths.size(); ++cell) {
    const double before = widths[cell + 1], width = widths[cell + 2], after = widths[cell + 3];
    const double left = 0.5 * (before + width), right = 0.5 * (width + after);  // V_l
    m_cells.push_back({.inverse_width = 1.0 / width,
                       .smallest_span = std::min({before, width, after}),
                       .left_value = {before / 6 / left, 2.0 / 3, width / 6 / left, 0.0},
                       .right_value = {0.0, width / 6 / right, 2.0 / 3, after / 6 / right},
                       .left_slope = {-0.5 / left, 0.0, 0.5 / left, 0.0},
                       .right_slope = {0.0, -0.5 / right, 0.0, 0.5 / right}});
  }
}

NodeLine Ddmp::nodes() const {
  return nodes_on_lines(m_lines, "DDMP");
}

}  // namespace mpm::basis
