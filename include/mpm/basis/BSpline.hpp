#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mpm/basis/KnotLines.hpp"
#include "mpm/core/Simd.hpp"

namespace mpm::basis {

/// One number for each function that reaches into a cell; those beyond the support are zero, so
/// that every basis fills a pack.
struct alignas(simd::pack_bytes) Values : std::array<double, simd::lanes> {
  simd::Pack pack() const { return simd::load(data()); }
};

/// What the splines do at the two ends of a direction.
enum class EndTreatment {
  mirror,    ///< knots reflected at the wall: the splines of a body and its mirrored twin
  open_knot  ///< end knots repeated order + 1 times, as in the paper
};

/// The nodes of one direction as the grid sees them: where they stand and how they fold.
struct NodeLine {
  KnotLines lines;
  std::vector<double> positions;   ///< Greville abscissae, m
  std::vector<double> cell_width;  ///< smallest knot span in a node's support, m
  int support;                     ///< functions that are not zero on a cell
  int owner_offset;                ///< the rank that owns node c + owner_offset owns cell c
  bool mirrored;                   ///< nodes beyond a wall fold onto node `reflected(a)`

  int count() const { return static_cast<int>(positions.size()); }
  /// Node that node a maps to by reflection at the first wall (for the last wall count from the
  /// other end). Nodes beyond the wall are those with a < reflected(a).
  int reflected(int a) const { return support - 2 - a; }
};

/// Univariate B-splines of one order on knot lines (Eqs. 10-11): on each cell a table of
/// polynomial coefficients, so that open, mirrored and graded lines are data and not branches.
template <int order_>
class BSpline {
 public:
  static constexpr int order = order_;
  static constexpr int support = order + 1;
  using Values = basis::Values;

  BSpline(KnotLines lines, EndTreatment ends);

  const KnotLines& lines() const { return m_lines; }
  int count() const { return m_lines.cells() + order; }
  NodeLine nodes() const;

  /// Function a of the cell is the global function `cell + a`.
  static int first_node(int cell) { return cell; }

  /// Smallest knot span in the support of the functions of this cell, m: the h_p of the time step.
  double smallest_span(int cell) const { return m_smallest_span[static_cast<std::size_t>(cell)]; }

  /// Weights N_a and gradients dN_a/dx (1/m) of the functions that reach into the cell at x.
  void evaluate(int cell, double x, Values& N, Values& dN) const {
    const Cell& piece = m_cells[static_cast<std::size_t>(cell)];
    const double xi = (x - piece.begin) * piece.inverse_width;
    simd::Pack value = simd::load(piece.coefficients[order].data());
    simd::Pack slope = double{order} * value;
    for (int power = order - 1; power >= 1; --power) {
      const simd::Pack coefficient = simd::load(piece.coefficients[power].data());
      value = value * xi + coefficient;
      slope = slope * xi + double(power) * coefficient;
    }
    simd::store(N.data(), value * xi + simd::load(piece.coefficients[0].data()));
    simd::store(dN.data(), slope * piece.inverse_width);
  }

 private:
  /// The functions on one cell as polynomials in xi in [0, 1]; power first, so that the functions
  /// of a cell lie side by side.
  struct Cell {
    double begin;
    double inverse_width;
    std::array<Values, support> coefficients;
  };

  Cell make_cell(int cell, const std::vector<double>& knots) const;

  KnotLines m_lines;
  EndTreatment m_ends;
  std::vector<double> m_greville;
  std::vector<double> m_smallest_span;
  std::vector<Cell> m_cells;
};

extern template class BSpline<1>;
extern template class BSpline<2>;
extern template class BSpline<3>;

}  // namespace mpm::basis
