#include "NodesOnLines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "mpm/core/Errors.hpp"

namespace mpm::basis {

std::vector<double> mirrored_widths(const KnotLines& lines, int beyond, const char* what) {
  const int n = lines.cells();
  if (n < beyond)
    throw BadInput(fmt::format("{} cells in a direction: {} needs at least {}", n, what, beyond));
  std::vector<double> widths;
  for (int k = -beyond; k < n + beyond; ++k)
    widths.push_back(lines.width(k < 0 ? -1 - k : k < n ? k : 2 * n - 1 - k));
  return widths;
}

NodeLine nodes_on_lines(const KnotLines& lines, const char* what) {
  const std::vector<double> widths = mirrored_widths(lines, 2, what);
  NodeLine nodes{lines, {}, {}, 4, 1, true};
  double position = lines.begin() - lines.width(0);
  for (std::size_t a = 0; a + 1 < widths.size(); ++a) {
    nodes.positions.push_back(position);
    nodes.cell_width.push_back(std::min(widths[a], widths[a + 1]));
    position += widths[a + 1];
  }
  return nodes;
}

}  // namespace mpm::basis
