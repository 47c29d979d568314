#pragma once

#include <vector>

#include "mpm/solver/Simulation.hpp"

namespace mpm::solver {

/// A square matrix, column by column.
struct DenseMatrix {
  int size = 0;
  std::vector<double> values;

  explicit DenseMatrix(int n) : size(n), values(static_cast<std::size_t>(n) * entries(n)) {}
  double* column(int j) { return values.data() + entries(size) * static_cast<std::size_t>(j); }

 private:
  static std::size_t entries(int n) { return static_cast<std::size_t>(n); }
};

/// Units of the state: velocities in `speed`, stresses in `modulus`, gradients in speed/length.
struct StateScales {
  double speed;    ///< m/s
  double modulus;  ///< Pa
  double length;   ///< m
};

/// One step as a linear map of the particles' velocities, stresses and, where carried, velocity
/// gradients, with particles held in place: T(dt) = T0 + dt T1 + dt^2 T2 in a linear elastic body,
/// dt in units of length/speed. The simulation must be at rest, without stress,
/// gravity and flip_time, and on one rank; it is left so. Collective.
template <int dim>
std::array<DenseMatrix, 3> one_step_matrices(Simulation<dim>& simulation,
                                             const StateScales& scales);

/// Largest modulus of the eigenvalues of T0 + dt T1 + dt^2 T2.
double spectral_radius(const std::array<DenseMatrix, 3>& T, double dt);

/// Square root of the largest modulus of the eigenvalues of a matrix: with the stress part of T2 of
/// -update usl, the largest frequency omega of the assembled body in units of speed/length.
double largest_frequency(const DenseMatrix& T2);

extern template std::array<DenseMatrix, 3> one_step_matrices(Simulation<1>&, const StateScales&);
extern template std::array<DenseMatrix, 3> one_step_matrices(Simulation<2>&, const StateScales&);
extern template std::array<DenseMatrix, 3> one_step_matrices(Simulation<3>&, const StateScales&);

}  // namespace mpm::solver
