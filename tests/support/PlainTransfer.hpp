#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "mpm/transfer/Transfer.hpp"

namespace mpm::test {

/// The sweeps of a step as their equations read, one particle and one node after another: what the
/// loops of src/transfer are held against. Nodal arrays are indexed as those of the grid's fields.
template <int dim, class Basis>
class PlainTransfer {
 public:
  using View = particles::ParticleView<dim>;

  PlainTransfer(const grid::Grid<dim>& grid, const std::array<Basis, dim>& bases)
      : m_grid(grid), m_bases(bases) {}

  void deposit(const View& particles, const Vector<dim>& b,
               transfer::MassMomentumForce<dim> nodes) const {
    for (int p = 0; p < particles.count; ++p)
      for_each_node(particles.position_of(p), [&](int I, double N, const Vector<dim>& dN) {
        const double m_p = particles.mass[p], V_p = particles.volume[p];
        nodes.mass[I] += m_p * N;
        for (int i = 0; i < dim; ++i) {
          nodes.momentum[i][I] += m_p * particles.velocity[i][p] * N;
          nodes.force[i][I] += m_p * b[i] * N;
          for (int j = 0; j < dim; ++j)
            nodes.force[i][I] -= V_p * particles.stress[component(i, j)][p] * dN[j];
        }
      });
  }

  /// A share of the velocity stays the particle's own, the rest is the grid's.
  void update_velocities_and_deposit(const View& particles, double dt, double share,
                                     transfer::VelocityAcceleration<dim> nodes,
                                     transfer::NodalVector<dim> momentum) const {
    for (int p = 0; p < particles.count; ++p) {
      const Vector<dim> x = particles.position_of(p);
      Vector<dim> v{}, a{};
      for_each_node(x, [&](int I, double N, const Vector<dim>&) {
        for (int i = 0; i < dim; ++i) {
          v[i] += nodes.velocity[i][I] * N;
          a[i] += nodes.acceleration[i][I] * N;
        }
      });
      for (int i = 0; i < dim; ++i)
        particles.velocity[i][p] =
            share * (particles.velocity[i][p] + a[i] * dt) + (1.0 - share) * v[i];
      for_each_node(x, [&](int I, double N, const Vector<dim>&) {
        for (int i = 0; i < dim; ++i)
          momentum.value[i][I] += particles.mass[p] * particles.velocity[i][p] * N;
      });
    }
  }

  /// Velocity gradients L[i][j] = dv_i/dx_j of all particles, which move.
  std::vector<std::array<Vector<dim>, dim>> strain_and_move(
      const View& particles, double dt, transfer::VelocityAcceleration<dim> nodes,
      transfer::NodalVector<dim> strain_velocity) const {
    std::vector<std::array<Vector<dim>, dim>> gradients;
    for (int p = 0; p < particles.count; ++p) {
      Vector<dim> v{};
      std::array<Vector<dim>, dim> L{};
      for_each_node(particles.position_of(p), [&](int I, double N, const Vector<dim>& dN) {
        for (int i = 0; i < dim; ++i) {
          v[i] += nodes.velocity[i][I] * N;
          for (int j = 0; j < dim; ++j) L[i][j] += strain_velocity.value[i][I] * dN[j];
        }
      });
      for (int i = 0; i < dim; ++i) {
        particles.position[i][p] += v[i] * dt;
        particles.displacement[i][p] += v[i] * dt;
      }
      gradients.push_back(L);
    }
    return gradients;
  }

  /// Where xx, yy, zz, xy, yz, xz stand.
  static int component(int i, int j) { return i == j ? i : i + j == 1 ? 3 : i + j == 3 ? 4 : 5; }

 private:
  using Values = std::array<typename Basis::Values, dim>;

  template <class Visit>
  void for_each_node(const Vector<dim>& x, const Visit& visit) const {
    std::array<int, dim> cell;
    Values N, dN;
    for (int d = 0; d < dim; ++d) {
      cell[d] = m_bases[d].lines().cell_of(x[d]);
      m_bases[d].evaluate(cell[d], x[d], N[d], dN[d]);
    }
    int nodes = 1;
    for (int d = 0; d < dim; ++d) nodes *= Basis::support;
    for (int k = 0; k < nodes; ++k) {
      std::array<int, dim> a, node;
      for (int d = 0, rest = k; d < dim; rest /= Basis::support, ++d) {
        a[d] = rest % Basis::support;
        node[d] = Basis::first_node(cell[d]) + a[d];
      }
      double product = 1.0;
      for (int d = 0; d < dim; ++d) product *= N[d][a[d]];
      visit(m_grid.local_index(node), product, gradient(cell, x, a, gradient_of(N, dN, a)));
    }
  }

  static Vector<dim> gradient_of(const Values& N, const Values& dN, const std::array<int, dim>& a) {
    Vector<dim> product;
    product.fill(1.0);
    for (int d = 0; d < dim; ++d)
      for (int e = 0; e < dim; ++e) product[e] *= e == d ? dN[d][a[d]] : N[d][a[d]];
    return product;
  }

  /// The plain gradient, or for dual bases blended with the smoothed one.
  Vector<dim> gradient(const std::array<int, dim>& cell, const Vector<dim>& x,
                       const std::array<int, dim>& a, Vector<dim> plain) const {
    if constexpr (transfer::DualBasis<Basis>) {
      Values value, slope;
      double alpha = 1.0;
      for (int d = 0; d < dim; ++d) {
        m_bases[d].evaluate_smoothed(cell[d], x[d], value[d], slope[d]);
        alpha *= std::pow(m_bases[d].bubble(cell[d], x[d]), 1 << (dim - 1));
      }
      const Vector<dim> smoothed = gradient_of(value, slope, a);
      for (int d = 0; d < dim; ++d) plain[d] = alpha * plain[d] + (1.0 - alpha) * smoothed[d];
    }
    return plain;
  }

  const grid::Grid<dim>& m_grid;
  const std::array<Basis, dim>& m_bases;
};

}  // namespace mpm::test
