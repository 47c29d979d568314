#include "mpm/basis/BSpline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mpm/core/Errors.hpp"

namespace mpm::basis {
namespace {

std::vector<double> knot_vector(const KnotLines& lines, EndTreatment ends, int order) {
  const int n = lines.cells();
  const bool mirror = ends == EndTreatment::mirror;
  std::vector<double> knots;
  for (int k = order; k >= 1; --k)
    knots.push_back(mirror ? 2.0 * lines.begin() - lines.line(k) : lines.begin());
  knots.insert(knots.end(), lines.positions().begin(), lines.positions().end());
  for (int k = 1; k <= order; ++k)
    knots.push_back(mirror ? 2.0 * lines.end() - lines.line(n - k) : lines.end());
  return knots;
}

/// Smallest distance of different knots among knots[first..last].
double smallest_difference(const std::vector<double>& knots, int first, int last) {
  double smallest = knots.back() - knots.front();
  for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k)
    if (knots[k + 1] > knots[k]) smallest = std::min(smallest, knots[k + 1] - knots[k]);
  return smallest;
}

double inverse_or_zero(double difference) {
  return difference == 0.0 ? 0.0 : 1.0 / difference;
}

}  // namespace

template <int order_>
BSpline<order_>::BSpline(KnotLines lines, EndTreatment ends)
    : m_lines(std::move(lines)), m_ends(ends) {
  if (m_lines.cells() < order)
    throw BadInput(fmt::format("{} cells in a direction: splines of order {} need at least {}",
                               m_lines.cells(), order, order));
  const std::vector<double> knots = knot_vector(m_lines, ends, order);
  for (int a = 0; a < count(); ++a) {
    double sum = 0.0;
    for (int k = 1; k <= order; ++k) sum += knots[static_cast<std::size_t>(a + k)];
    m_greville.push_back(sum / order);
  }
  for (int cell = 0; cell < m_lines.cells(); ++cell) {
    m_cells.push_back(make_cell(cell, knots));
    m_smallest_span.push_back(smallest_difference(knots, cell, cell + 2 * order + 1));
  }
}

/// Cox-de Boor (Eqs. 10-11) carried out on the polynomials themselves.
template <int order_>
auto BSpline<order_>::make_cell(int cell, const std::vector<double>& knots) const -> Cell {
  const double begin = m_lines.line(cell);
  const double width = m_lines.width(cell);
  std::array<std::array<double, support>, support> N{};  // N[a][power]
  N[order][0] = 1.0;                                     // degree 0: only the cell's own function
  for (int degree = 1; degree <= order; ++degree) {
    for (int a = order - degree; a <= order; ++a) {
      const auto i = static_cast<std::size_t>(cell + a);
      const auto d = static_cast<std::size_t>(degree);
      const double up = inverse_or_zero(knots[i + d] - knots[i]);
      const double down = inverse_or_zero(knots[i + d + 1] - knots[i + 1]);
      std::array<double, support> sum{};
      for (int power = 0; power < degree; ++power) {
        sum[power] += N[a][power] * (begin - knots[i]) * up;
        sum[power + 1] += N[a][power] * width * up;
        if (a == order) continue;
        sum[power] += N[a + 1][power] * (knots[i + d + 1] - begin) * down;
        sum[power + 1] -= N[a + 1][power] * width * down;
      }
      N[a] = sum;
    }
  }
  Cell piece{begin, 1.0 / width, {}};
  for (int a = 0; a < support; ++a)
    for (int power = 0; power < support; ++power) piece.coefficients[power][a] = N[a][power];
  return piece;
}

template <int order_>
NodeLine BSpline<order_>::nodes() const {
  NodeLine nodes{m_lines, m_greville, {}, support, order / 2, m_ends == EndTreatment::mirror};
  const std::vector<double> knots = knot_vector(m_lines, m_ends, order);
  for (int a = 0; a < count(); ++a)
    nodes.cell_width.push_back(smallest_difference(knots, a, a + support));
  return nodes;
}

template class BSpline<1>;
template class BSpline<2>;
template class BSpline<3>;

}  // namespace mpm::basis
