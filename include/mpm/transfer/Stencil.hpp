#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mpm/core/Simd.hpp"
#include "mpm/grid/Grid.hpp"

namespace mpm::transfer {

/// A basis whose gradient is blended with a smoothed one, which see basis/Ddmp.hpp.
template <class Basis>
concept DualBasis = requires(const Basis& basis, typename Basis::Values& values) {
  basis.evaluate_smoothed(0, 0.0, values, values);
};

/// A vector at four neighbouring nodes of a row.
template <int dim>
using PackVector = std::array<simd::Pack, static_cast<std::size_t>(dim)>;

/// The nodes that a point touches, with N_Ip and its gradient as products of univariate functions.
///
/// Nodes are visited in rows along x, in which nodal arrays are contiguous: the four nodes of a row
/// are one pack. Bases with fewer functions have zeros at the end, and so may rows at the end of
/// nodal arrays, which are padded for that. The weights are found anew in every sweep: reading
/// them back would cost more.
template <int dim, class Basis>
class Stencil {
 public:
  /// `mass` are local values of a nodal field, for dual bases: where one of its nodes has none, a
  /// smoothed gradient would reach out of the body, and the plain one is taken. Null: all have.
  Stencil(const grid::Grid<dim>& grid, const std::array<Basis, dim>& bases,
          const double* mass = nullptr)
      : m_bases(bases), m_mass(mass) {
    std::ptrdiff_t stride = 1;
    for (int d = 0; d < dim; ++d) {
      m_stride[d] = stride;
      m_begin[d] = grid.ghosted_nodes().begin[d];
      m_positions[d] = &grid.nodes(d).positions;
      stride *= grid.ghosted_nodes().extent(d);
    }
    m_cell.fill(0);
    renew_first();
  }

  /// Moves to the point x, which must lie in a reachable cell.
  void move_to(const Vector<dim>& x) {
    find_cell_of(x);
    evaluate_at(x);
  }

  /// Moves to the point x with the functions of the reachable cell that holds `inside`, continued
  /// if x lies beyond that cell.
  void move_to_continued(const Vector<dim>& inside, const Vector<dim>& x) {
    find_cell_of(inside);
    evaluate_at(x);
  }

  /// The cell of the last move.
  const std::array<int, dim>& cell() const { return m_cell; }
  /// Whether x lies in this cell, without looking for its own; never for NaN.
  bool holds(const std::array<int, dim>& cell, const Vector<dim>& x) const {
    bool inside = true;
    for (int d = 0; d < dim; ++d) inside &= m_bases[d].lines().cell_holds(cell[d], x[d]);
    return inside;
  }

  /// visit(local index of the first of four nodes, N_Ip, gradient of N_Ip) row by row, in the order
  /// of the nodal arrays.
  template <class Visit>
  void for_each_row(const Visit& visit) const {
    if constexpr (DualBasis<Basis>)
      for_each_blended_row(visit);
    else
      for_each_product(m_N, m_dN, visit);
  }

  /// visit(local node index, N_Ip, gradient of N_Ip), node by node.
  template <class Visit>
  void for_each_node(const Visit& visit) const {
    for_each_row([&](std::ptrdiff_t first, simd::Pack N, const PackVector<dim>& gradient) {
      for (int a = 0; a < Basis::support; ++a) {
        Vector<dim> at_node;
        for (int d = 0; d < dim; ++d) at_node[d] = gradient[d][a];
        visit(first + a, N[a], at_node);
      }
    });
  }

  /// visit(first node, N_Ip, N_Ip (x_I - x_p)) row by row: the moments that affine transfers carry.
  template <class Visit>
  void for_each_moment_row(const Visit& visit) const {
    std::array<Values, dim> moment{};
    for (int d = 0; d < dim; ++d)
      for (std::size_t a = 0; a < Basis::support; ++a) moment[d][a] = m_N[d][a] * offset(d, a);
    for_each_product(m_N, moment, visit);
  }

  /// sum_I N_Ip (x_I - x_p)_d^2, m^2.
  double second_moment(int d) const {
    double sum = 0.0;
    for (std::size_t a = 0; a < Basis::support; ++a) sum += m_N[d][a] * offset(d, a) * offset(d, a);
    return sum;
  }

 private:
  using Values = typename Basis::Values;

  /// visit(first node, products of `N`, vector of the products with `dN` in place of one of them).
  template <class Visit>
  void for_each_product(const std::array<Values, dim>& N, const std::array<Values, dim>& dN,
                        const Visit& visit) const {
    constexpr int support = Basis::support;
    const simd::Pack Nx = N[0].pack(), dNx = dN[0].pack();
    if constexpr (dim == 1) {
      visit(m_first, Nx, PackVector<1>{dNx});
    } else if constexpr (dim == 2) {
      for (int j = 0; j < support; ++j)
        visit(m_first + j * m_stride[1], Nx * N[1][j], PackVector<2>{dNx * N[1][j], Nx * dN[1][j]});
    } else {
      for (int k = 0; k < support; ++k)
        for (int j = 0; j < support; ++j) {
          const double NN = N[1][j] * N[2][k];
          const double dNN = dN[1][j] * N[2][k], NdN = N[1][j] * dN[2][k];
          visit(m_first + k * m_stride[2] + j * m_stride[1], Nx * NN,
                PackVector<3>{dNx * NN, Nx * dNN, Nx * NdN});
        }
    }
  }

  template <class Visit>
  void for_each_blended_row(const Visit& visit) const {
    std::array<Values, dim> value, slope;
    double alpha = 1.0;
    for (int d = 0; d < dim; ++d) {
      m_bases[d].evaluate_smoothed(m_cell[d], m_x[d], value[d], slope[d]);
      double bubble = m_bases[d].bubble(m_cell[d], m_x[d]);
      for (int e = 1; e < dim; ++e) bubble *= bubble;  // every N_l stands in 2^(dim - 1) corners
      alpha *= bubble;
    }
    std::array<PackVector<dim>, power(Basis::support, dim - 1)> smoothed;
    std::size_t row = 0;
    for_each_product(value, slope,
                     [&](std::ptrdiff_t I, simd::Pack, const PackVector<dim>& gradient) {
                       smoothed[row++] = gradient;
                       if (m_mass == nullptr) return;
                       for (int a = 0; a < Basis::support; ++a)
                         if (!(m_mass[I + a] > 0.0)) alpha = 1.0;
                     });
    row = 0;
    for_each_product(m_N, m_dN, [&](std::ptrdiff_t I, simd::Pack N, PackVector<dim> gradient) {
      for (int d = 0; d < dim; ++d)
        gradient[d] = alpha * gradient[d] + (1.0 - alpha) * smoothed[row][d];
      ++row;
      visit(I, N, gradient);
    });
  }

  static constexpr std::size_t power(int base, int exponent) {
    return exponent == 0 ? 1 : static_cast<std::size_t>(base) * power(base, exponent - 1);
  }

  double offset(int d, std::size_t a) const {
    const auto first = static_cast<std::size_t>(Basis::first_node(m_cell[d]));
    return (*m_positions[d])[first + a] - m_x[d];
  }

  /// Sorted particles mostly stay in the cell of the one before.
  void find_cell_of(const Vector<dim>& x) {
    if (holds(m_cell, x)) return;
    for (int d = 0; d < dim; ++d) m_cell[d] = m_bases[d].lines().cell_near(m_cell[d], x[d]);
    renew_first();
  }

  void renew_first() {
    m_first = 0;
    for (int d = 0; d < dim; ++d)
      m_first += (Basis::first_node(m_cell[d]) - m_begin[d]) * m_stride[d];
  }

  void evaluate_at(const Vector<dim>& x) {
    m_x = x;
    for (int d = 0; d < dim; ++d) m_bases[d].evaluate(m_cell[d], x[d], m_N[d], m_dN[d]);
  }

  const std::array<Basis, dim>& m_bases;
  const double* m_mass;
  std::array<std::ptrdiff_t, dim> m_stride;
  std::array<int, dim> m_begin;
  std::array<const std::vector<double>*, dim> m_positions;
  std::ptrdiff_t m_first = 0;
  std::array<int, dim> m_cell;
  Vector<dim> m_x;
  std::array<Values, dim> m_N, m_dN;
};

}  // namespace mpm::transfer
