#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mpm/basis/BSpline.hpp"

namespace mpm::basis {

/// Dual domain material points (Zhang, Ma & Giguere 2011, J. Comput. Phys. 230:6379): linear
/// functions N_I, whose gradient is blended with one that is continuous between cells,
///
///     alpha grad N_I + (1 - alpha) sum_l N_l(x)/V_l int N_l grad N_I dV,   V_l = int N_l dV.
///
/// alpha = n^n prod N_l over the n corners of the cell is 1 in its middle and 0 on its faces. In
/// the integral the directions separate: the smoothed gradient is the product of `slope` in one
/// direction and `value` in the others. Ends are always mirrored.
class Ddmp {
 public:
  static constexpr int support = 4;
  static constexpr int order = 1;
  using Values = basis::Values;

  explicit Ddmp(KnotLines lines);

  const KnotLines& lines() const { return m_lines; }
  int count() const { return m_lines.cells() + 3; }
  NodeLine nodes() const;

  /// Node a of the grid stands on line a - 1; the first and the last one beyond the walls.
  static int first_node(int cell) { return cell; }

  /// Smallest cell that the functions of this cell reach into, m.
  double smallest_span(int cell) const { return m_cells[index(cell)].smallest_span; }

  /// Linear functions of the lines cell - 1 to cell + 2, the outer two zero, and their slopes.
  void evaluate(int cell, double x, Values& N, Values& dN) const {
    const double xi = local(cell, x), inverse = m_cells[index(cell)].inverse_width;
    N = {0.0, 1.0 - xi, xi, 0.0};
    dN = {0.0, -inverse, inverse, 0.0};
  }

  /// sum_l N_l(x)/V_l int N_l N_a dx and sum_l N_l(x)/V_l int N_l N_a' dx.
  void evaluate_smoothed(int cell, double x, Values& value, Values& slope) const {
    const Cell& at = m_cells[index(cell)];
    const double right = local(cell, x), left = 1.0 - right;
    for (std::size_t a = 0; a < support; ++a) {
      value[a] = left * at.left_value[a] + right * at.right_value[a];
      slope[a] = left * at.left_slope[a] + right * at.right_slope[a];
    }
  }

  /// 4 N_l N_r of this direction: 1 in the middle of the cell, 0 at its ends.
  double bubble(int cell, double x) const {
    const double xi = std::clamp(local(cell, x), 0.0, 1.0);
    return 4.0 * xi * (1.0 - xi);
  }

 private:
  /// The projections at the two lines of a cell.
  struct Cell {
    double inverse_width, smallest_span;
    Values left_value, right_value, left_slope, right_slope;
  };

  static std::size_t index(int cell) { return static_cast<std::size_t>(cell); }
  double local(int cell, double x) const {
    return (x - m_lines.line(cell)) * m_cells[index(cell)].inverse_width;
  }

  KnotLines m_lines;
  std::vector<Cell> m_cells;
};

}  // namespace mpm::basis
