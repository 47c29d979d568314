#include "mpm/solver/OneStepMatrix.hpp"

#include <petscblaslapack.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace mpm::solver {
namespace {

/// So small that positions and volumes do not notice: the step is linear to round-off.
constexpr double tiny = 1e-20;

/// The state variables of all particles, one array after the other, each with its unit.
template <int dim>
class StateVector {
 public:
  StateVector(const Simulation<dim>& simulation, const StateScales& scales)
      : m_view(simulation.particles().view()) {
    for (double* v : m_view.velocity) m_arrays.push_back({v, tiny * scales.speed});
    for (int k : stress_components())
      m_arrays.push_back({m_view.stress[static_cast<std::size_t>(k)], tiny * scales.modulus});
    for (const auto& row : m_view.velocity_gradient)
      for (double* component : row)
        if (component != nullptr)
          m_arrays.push_back({component, tiny * scales.speed / scales.length});
  }

  int size() const { return m_view.count * static_cast<int>(m_arrays.size()); }
  void set_to_zero() const {
    for (const auto& array : m_arrays) std::fill_n(array.values, m_view.count, 0.0);
  }
  void set_to_one(int j) const { entry(j) = unit(j); }
  void copy_to(double* values) const {
    for (int i = 0; i < size(); ++i) values[i] = entry(i) / unit(i);
  }

 private:
  struct Array {
    double* values;
    double unit;
  };

  /// In plane strain the stress out of the plane acts on nothing.
  static std::vector<int> stress_components() {
    if constexpr (dim == 1) return {0};
    if constexpr (dim == 2) return {0, 1, 3};
    if constexpr (dim == 3) return {0, 1, 2, 3, 4, 5};
  }
  const Array& array_of(int j) const {
    return m_arrays[static_cast<std::size_t>(j / m_view.count)];
  }
  double& entry(int j) const { return array_of(j).values[j % m_view.count]; }
  double unit(int j) const { return array_of(j).unit; }

  particles::ParticleView<dim> m_view;
  std::vector<Array> m_arrays;
};

/// The state's matrix of one step of length dt, s.
template <int dim>
DenseMatrix one_step_matrix(Simulation<dim>& simulation, const StateScales& scales, double dt) {
  DenseMatrix T(StateVector<dim>(simulation, scales).size());
  for (int j = 0; j < T.size; ++j) {
    {
      const StateVector<dim> state(simulation, scales);
      state.set_to_zero();
      state.set_to_one(j);
    }
    simulation.assume_last_step(dt);
    simulation.advance(0.0, simulation.plan(dt));
    StateVector<dim>(simulation, scales).copy_to(T.column(j));
  }
  StateVector<dim>(simulation, scales).set_to_zero();
  return T;
}

std::vector<double> moduli_of_eigenvalues(DenseMatrix matrix) {
  auto n = static_cast<PetscBLASInt>(matrix.size);
  std::vector<double> real(static_cast<std::size_t>(n)), imaginary = real;
  PetscBLASInt one = 1, length = 64 * n, info = 0;
  std::vector<double> work(static_cast<std::size_t>(length));
  LAPACKgeev_("N", "N", &n, matrix.values.data(), &n, real.data(), imaginary.data(), nullptr, &one,
              nullptr, &one, work.data(), &length, &info);
  if (info != 0) throw std::runtime_error("LAPACK found no eigenvalues of the one-step matrix");
  std::vector<double> moduli;
  for (std::size_t k = 0; k < real.size(); ++k) moduli.push_back(std::hypot(real[k], imaginary[k]));
  return moduli;
}

double largest_modulus(const DenseMatrix& matrix) {
  const std::vector<double> moduli = moduli_of_eigenvalues(matrix);
  return *std::max_element(moduli.begin(), moduli.end());
}

}  // namespace

template <int dim>
std::array<DenseMatrix, 3> one_step_matrices(Simulation<dim>& simulation,
                                             const StateScales& scales) {
  const double unit = scales.length / scales.speed;
  // A quadratic through dt = 1, 2, 3.
  const DenseMatrix A = one_step_matrix(simulation, scales, unit);
  const DenseMatrix B = one_step_matrix(simulation, scales, 2 * unit);
  const DenseMatrix C = one_step_matrix(simulation, scales, 3 * unit);
  std::array<DenseMatrix, 3> T{A, A, A};
  for (std::size_t k = 0; k < A.values.size(); ++k) {
    const double a = A.values[k], b = B.values[k], c = C.values[k];
    T[0].values[k] = 3 * a - 3 * b + c;
    T[1].values[k] = -2.5 * a + 4 * b - 1.5 * c;
    T[2].values[k] = 0.5 * a - b + 0.5 * c;
  }
  return T;
}

double spectral_radius(const std::array<DenseMatrix, 3>& T, double dt) {
  DenseMatrix sum = T[0];
  for (std::size_t k = 0; k < sum.values.size(); ++k)
    sum.values[k] += dt * (T[1].values[k] + dt * T[2].values[k]);
  return largest_modulus(sum);
}

double largest_frequency(const DenseMatrix& T2) {
  return std::sqrt(largest_modulus(T2));
}

template std::array<DenseMatrix, 3> one_step_matrices(Simulation<1>&, const StateScales&);
template std::array<DenseMatrix, 3> one_step_matrices(Simulation<2>&, const StateScales&);
template std::array<DenseMatrix, 3> one_step_matrices(Simulation<3>&, const StateScales&);

}  // namespace mpm::solver
