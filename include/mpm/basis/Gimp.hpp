#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mpm/basis/BSpline.hpp"

namespace mpm::basis {

/// Uniform generalised interpolation (uGIMP; Bardenhagen & Kober 2004): the linear function of each
/// grid line averaged over the particle's extent, which is that of the seeding in the present cell
/// and does not deform. Lines may be graded; ends are always mirrored.
class Gimp {
 public:
  static constexpr int support = 4;
  static constexpr int order = 1;
  using Values = basis::Values;

  /// `particles_per_cell` in this direction gives the particle's extent.
  Gimp(KnotLines lines, int particles_per_cell);

  const KnotLines& lines() const { return m_lines; }
  int count() const { return m_lines.cells() + 3; }
  NodeLine nodes() const;

  /// Node a of the grid stands on line a - 1; the first and the last one beyond the walls.
  static int first_node(int cell) { return cell; }

  /// Smallest cell that the functions of this cell reach into, m.
  double smallest_span(int cell) const { return m_smallest_span[static_cast<std::size_t>(cell)]; }

  /// Averages over x +- l of the hats of the lines cell - 1 to cell + 2, and their slopes; beyond
  /// the cell they are continued as straight lines, so that their sum stays 1.
  void evaluate(int cell, double x, Values& S, Values& dS) const {
    const auto c = static_cast<std::size_t>(cell);
    const double l = m_half_extent[c];
    const double inverse = 0.5 / l;
    const double inside = std::clamp(x, m_lines.line(cell), m_lines.line(cell + 1));
    for (std::size_t a = 0; a < support; ++a) {
      const Hat& hat = m_hats[c + a];
      dS[a] = inverse * (hat.value(inside + l) - hat.value(inside - l));
      S[a] = inverse * (hat.integral(inside + l) - hat.integral(inside - l)) + dS[a] * (x - inside);
    }
  }

 private:
  /// The linear function of a line.
  struct Hat {
    double middle, left, right;  ///< m; left and right are the widths of its two cells

    double value(double x) const {
      const double r = x - middle;
      if (r <= -left || r >= right) return 0.0;
      return r < 0.0 ? 1.0 + r / left : 1.0 - r / right;
    }
    /// From minus infinity to x.
    double integral(double x) const {
      const double r = x - middle;
      if (r <= -left) return 0.0;
      if (r >= right) return 0.5 * (left + right);
      if (r < 0.0) return 0.5 * (r + left) * (r + left) / left;
      return 0.5 * (left + right) - 0.5 * (right - r) * (right - r) / right;
    }
  };

  KnotLines m_lines;
  std::vector<Hat> m_hats;
  std::vector<double> m_half_extent, m_smallest_span;
};

}  // namespace mpm::basis
