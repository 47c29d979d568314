#pragma once

#include <array>

#include "mpm/grid/Grid.hpp"

namespace mpm::transfer {

/// The nodes that a point touches, with N_Ip and its gradient as products of univariate splines.
template <int dim, class Basis>
class Stencil {
 public:
  Stencil(const grid::Grid<dim>& grid, const std::array<Basis, dim>& bases) : m_bases(bases) {
    std::ptrdiff_t stride = 1;
    for (int d = 0; d < dim; ++d) {
      m_stride[d] = stride;
      m_begin[d] = grid.ghosted_nodes().begin[d];
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
    constexpr int support = Basis::support;
    if constexpr (dim == 1) {
      for (int i = 0; i < support; ++i) visit(m_first + i, m_N[0][i], Vector<1>{m_dN[0][i]});
    } else if constexpr (dim == 2) {
      for (int j = 0; j < support; ++j)
        for (int i = 0; i < support; ++i)
          visit(m_first + j * m_stride[1] + i, m_N[0][i] * m_N[1][j],
                Vector<2>{m_dN[0][i] * m_N[1][j], m_N[0][i] * m_dN[1][j]});
    } else {
      for (int k = 0; k < support; ++k)
        for (int j = 0; j < support; ++j) {
          const double NN = m_N[1][j] * m_N[2][k];
          const double dNN = m_dN[1][j] * m_N[2][k], NdN = m_N[1][j] * m_dN[2][k];
          for (int i = 0; i < support; ++i)
            visit(m_first + k * m_stride[2] + j * m_stride[1] + i, m_N[0][i] * NN,
                  Vector<3>{m_dN[0][i] * NN, m_N[0][i] * dNN, m_N[0][i] * NdN});
        }
    }
  }

 private:
  void evaluate(int d, int cell, double x) {
    m_bases[d].evaluate(cell, x, m_N[d], m_dN[d]);
    m_first += (Basis::first_node(cell) - m_begin[d]) * m_stride[d];
  }

  const std::array<Basis, dim>& m_bases;
  std::array<std::ptrdiff_t, dim> m_stride;
  std::array<int, dim> m_begin;
  std::ptrdiff_t m_first = 0;
  std::array<typename Basis::Values, dim> m_N, m_dN;
};

}  // namespace mpm::transfer
