#pragma once

#include <cstddef>
#include <vector>

namespace mpm::basis {

/// The grid lines of one direction, x_0 < x_1 < ... < x_n in metres, and the cells between them.
class KnotLines {
 public:
  /// Throws BadInput unless there are at least two finite, strictly increasing positions.
  explicit KnotLines(std::vector<double> positions);

  /// n equal cells from `begin` to `end`.
  static KnotLines uniform(double begin, double end, int cells);

  /// Cells of the width `cell` within [fine_begin, fine_end], from there to both sides each 5 %
  /// wider than the one before, up to `ratio` times `cell`. They are laid from `origin` to both
  /// sides; the last lines may lie beyond `begin` and `end` by less than a cell.
  struct Graded {
    double begin, end;
    double fine_begin, fine_end;
    double origin;  ///< within the fine part
    double cell;
    double ratio = 1.0;
  };
  static KnotLines graded(const Graded& wanted);

  int cells() const { return static_cast<int>(m_positions.size()) - 1; }
  double begin() const { return m_positions.front(); }
  double end() const { return m_positions.back(); }
  double line(int k) const { return m_positions[static_cast<std::size_t>(k)]; }
  double width(int cell) const { return line(cell + 1) - line(cell); }
  double smallest_width() const { return m_smallest_width; }
  bool is_uniform() const { return m_uniform; }
  const std::vector<double>& positions() const { return m_positions; }

  /// Whether a cell of the grid holds x; never for NaN. False on the last line, which cell_of
  /// counts to the last cell.
  bool cell_holds(int cell, double x) const { return x >= line(cell) && x < line(cell + 1); }

  /// The same as cell_of, faster where `guess` is right, as that of a neighbour mostly is.
  int cell_near(int guess, double x) const { return cell_holds(guess, x) ? guess : cell_of(x); }

  /// The cell that holds x; -1 below the first line, cells() above the last, NaN gives -1.
  int cell_of(double x) const {
    if (!(x >= begin())) return -1;
    if (x >= end()) return x > end() ? cells() : cells() - 1;
    int cell = m_first_cell_of_bin[static_cast<std::size_t>((x - begin()) * m_bins_per_length)];
    while (x >= line(cell + 1)) ++cell;
    while (x < line(cell)) --cell;
    return cell;
  }

 private:
  std::vector<double> m_positions;
  double m_smallest_width;
  bool m_uniform;
  double m_bins_per_length;
  /// Bins of equal width, narrower than any cell: a look-up is one or two comparisons.
  std::vector<int> m_first_cell_of_bin;
};

}  // namespace mpm::basis
