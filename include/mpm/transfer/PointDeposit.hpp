#pragma once

#include <array>
#include <span>

#include "mpm/grid/NodalField.hpp"
#include "mpm/transfer/Stencil.hpp"

namespace mpm::transfer {

/// Deposits points that are no particles (a rigid body's) on the grid, whatever its basis.
template <int dim>
class PointDeposit {
 public:
  virtual ~PointDeposit() = default;
  /// Adds weight N_I(x) to the first component of the field and weight grad N_I(x) to the others,
  /// for the points in `cells`, which this rank must reach. Local.
  virtual void deposit(std::span<const Vector<dim>> points, double weight,
                       const grid::CellSet<dim>& cells, grid::NodalField<dim>& field) const = 0;
  /// Adds values_d N_I(x) to component d of the field, for points in cells that this rank reaches.
  /// Local.
  virtual void deposit_vectors(std::span<const Vector<dim>> points,
                               std::span<const Vector<dim>> values,
                               grid::NodalField<dim>& field) const = 0;
};

template <int dim, class Basis>
class BasisDeposit : public PointDeposit<dim> {
 public:
  BasisDeposit(const grid::Grid<dim>& grid, const std::array<Basis, dim>& bases)
      : m_grid(grid), m_bases(bases) {}

  void deposit(std::span<const Vector<dim>> points, double weight, const grid::CellSet<dim>& cells,
               grid::NodalField<dim>& field) const override {
    Stencil<dim, Basis> stencil(m_grid, m_bases);
    for (const Vector<dim>& x : points) {
      if (!cells.contains(m_grid.cell_of(x))) continue;
      stencil.move_to(x);
      stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>& gradient) {
        field.values(0)[I] += weight * N;
        for (int d = 0; d < dim; ++d) field.values(1 + d)[I] += weight * gradient[d];
      });
    }
  }

  void deposit_vectors(std::span<const Vector<dim>> points, std::span<const Vector<dim>> values,
                       grid::NodalField<dim>& field) const override {
    Stencil<dim, Basis> stencil(m_grid, m_bases);
    for (std::size_t k = 0; k < points.size(); ++k) {
      stencil.move_to(points[k]);
      stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>&) {
        for (int d = 0; d < dim; ++d) field.values(d)[I] += values[k][d] * N;
      });
    }
  }

 private:
  const grid::Grid<dim>& m_grid;
  const std::array<Basis, dim>& m_bases;
};

}  // namespace mpm::transfer
