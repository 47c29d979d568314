#pragma once

#include <array>

#include "mpm/grid/Grid.hpp"

namespace mpm::transfer {

/// A basis whose gradient is blended with a smoothed one, which see basis/Ddmp.hpp.
template <class Basis>
concept DualBasis = requires(const Basis& basis, typename Basis::Values& values) {
  basis.evaluate_smoothed(0, 0.0, values, values);
};

/// The nodes that a point touches, with N_Ip and its gradient as products of univariate functions.
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
  }

  /// Moves to the point x, which must lie in a reachable cell.
  void move_to(const Vector<dim>& x) {
    m_first = 0;
    for (int d = 0; d < dim; ++d) evaluate(d, m_bases[d].lines().cell_of(x[d]), x[d]);
  }

  /// Moves to the point x with the functions of the reachable cell that holds `inside`, continued
  /// if x lies beyond that cell.
  void move_to_continued(const Vector<dim>& inside, const Vector<dim>& x) {
    m_first = 0;
    for (int d = 0; d < dim; ++d) evaluate(d, m_bases[d].lines().cell_of(inside[d]), x[d]);
  }

  /// visit(local node index, N_Ip, gradient of N_Ip) in the order of the nodal arrays.
  template <class Visit>
  void for_each_node(const Visit& visit) const {
    if constexpr (DualBasis<Basis>)
      for_each_product_blended(visit);
    else
      for_each_product(m_N, m_dN, visit);
  }

  /// visit(local node index, N_Ip, N_Ip (x_I - x_p)): the moments that affine transfers carry.
  template <class Visit>
  void for_each_moment(const Visit& visit) const {
    std::array<Values, dim> moment;
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

  /// visit(node, products of `N`, vector of the products with `dN` in place of one of them).
  template <class Visit>
  void for_each_product(const std::array<Values, dim>& N, const std::array<Values, dim>& dN,
                        const Visit& visit) const {
    constexpr int support = Basis::support;
    if constexpr (dim == 1) {
      for (int i = 0; i < support; ++i) visit(m_first + i, N[0][i], Vector<1>{dN[0][i]});
    } else if constexpr (dim == 2) {
      for (int j = 0; j < support; ++j)
        for (int i = 0; i < support; ++i)
          visit(m_first + j * m_stride[1] + i, N[0][i] * N[1][j],
                Vector<2>{dN[0][i] * N[1][j], N[0][i] * dN[1][j]});
    } else {
      for (int k = 0; k < support; ++k)
        for (int j = 0; j < support; ++j) {
          const double NN = N[1][j] * N[2][k];
          const double dNN = dN[1][j] * N[2][k], NdN = N[1][j] * dN[2][k];
          for (int i = 0; i < support; ++i)
            visit(m_first + k * m_stride[2] + j * m_stride[1] + i, N[0][i] * NN,
                  Vector<3>{dN[0][i] * NN, N[0][i] * dNN, N[0][i] * NdN});
        }
    }
  }

  template <class Visit>
  void for_each_product_blended(const Visit& visit) const {
    std::array<Values, dim> value, slope;
    double alpha = 1.0;
    for (int d = 0; d < dim; ++d) {
      m_bases[d].evaluate_smoothed(m_cell[d], m_x[d], value[d], slope[d]);
      double bubble = m_bases[d].bubble(m_cell[d], m_x[d]);
      for (int e = 1; e < dim; ++e) bubble *= bubble;  // every N_l stands in 2^(dim - 1) corners
      alpha *= bubble;
    }
    std::array<Vector<dim>, power(Basis::support, dim)> smoothed;
    std::size_t k = 0;
    for_each_product(value, slope, [&](std::ptrdiff_t I, double, const Vector<dim>& gradient) {
      smoothed[k++] = gradient;
      if (m_mass != nullptr && !(m_mass[I] > 0.0)) alpha = 1.0;
    });
    k = 0;
    for_each_product(m_N, m_dN, [&](std::ptrdiff_t I, double N, Vector<dim> gradient) {
      for (int d = 0; d < dim; ++d)
        gradient[d] = alpha * gradient[d] + (1.0 - alpha) * smoothed[k][d];
      ++k;
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

  void evaluate(int d, int cell, double x) {
    m_cell[d] = cell;
    m_x[d] = x;
    m_bases[d].evaluate(cell, x, m_N[d], m_dN[d]);
    m_first += (Basis::first_node(cell) - m_begin[d]) * m_stride[d];
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
