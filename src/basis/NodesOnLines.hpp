#pragma once

#include <vector>

#include "mpm/basis/BSpline.hpp"

namespace mpm::basis {

/// Widths of the cells with `beyond` mirrored ones on either side, m. Throws BadInput if there are
/// fewer cells than that; `what` is the basis that asks.
std::vector<double> mirrored_widths(const KnotLines& lines, int beyond, const char* what);

/// One node per line and a mirrored one beyond either wall: node a stands on line a - 1. For bases
/// made of the lines' linear functions that reach a cell further.
NodeLine nodes_on_lines(const KnotLines& lines, const char* what);

}  // namespace mpm::basis
