#include "mpm/material/NeoHookean.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "mpm/core/Errors.hpp"

namespace mpm::material {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix matrix(const SymmetricTensor& a) {
  return {{{a[0], a[3], a[5]}, {a[3], a[1], a[4]}, {a[5], a[4], a[2]}}};
}

SymmetricTensor symmetric(const Matrix& a) {
  return {{a[0][0], a[1][1], a[2][2], a[0][1], a[1][2], a[0][2]}};
}

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

/// exp(e) by its series, which ends early for the increments of a step.
Matrix exponential(const SymmetricTensor& e) {
  const Matrix E = matrix(e);
  Matrix sum{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, term = sum;
  const double size = norm(e);
  double bound = 1.0;
  for (int n = 1; bound > 1e-18 && n < 60; ++n) {
    term = product(term, E);
    bound *= size / n;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        term[i][j] /= n;
        sum[i][j] += term[i][j];
      }
  }
  return sum;
}

}  // namespace

NeoHookean::NeoHookean(const NeoHookeanParameters& parameters)
    : m_parameters(parameters),
      m_lambda(parameters.youngs_modulus * parameters.poisson_ratio /
               ((1.0 + parameters.poisson_ratio) * (1.0 - 2.0 * parameters.poisson_ratio))),
      m_mu(parameters.youngs_modulus / (2.0 * (1.0 + parameters.poisson_ratio))) {
  const double nu = parameters.poisson_ratio;
  if (!(nu > -1.0 && nu < 0.5))
    throw BadInput(fmt::format("Poisson's ratio {} must lie between -1 and 0.5", nu));
}

std::span<const StateVariable> NeoHookean::state_variables() const {
  static const std::array<StateVariable, 1> variables{
      {{"volume_ratio", "volume over initial volume", "1", 1.0}}};
  return variables;
}

void NeoHookean::update_stress(const Batch& batch) const {
  double* J = batch.state[0];
  for (std::size_t p = 0; p < batch.size; ++p) {
    const SymmetricTensor e = batch.strain_increment.load(p);
    SymmetricTensor b = (J[p] / m_mu) * batch.stress.load(p);
    for (int k = 0; k < 3; ++k) b[k] += 1.0 - m_lambda / m_mu * std::log(J[p]);
    const Matrix F = exponential(e);
    b = symmetric(product(product(F, matrix(b)), F));
    J[p] *= std::exp(trace(e));
    for (int k = 0; k < 3; ++k) b[k] -= 1.0 - m_lambda / m_mu * std::log(J[p]);
    batch.stress.store(p, (m_mu / J[p]) * b);
  }
}

/// Largest longitudinal modulus along the principal axes is bounded by that along the longest
/// stretch; b's trace bounds it from above.
void NeoHookean::wave_modulus(const Batch& batch, std::span<double> modulus) const {
  const double* J = batch.state[0];
  for (std::size_t p = 0; p < batch.size; ++p) {
    const SymmetricTensor stress = batch.stress.load(p);
    double largest = 0.0;
    for (int k = 0; k < 3; ++k) largest = std::max(largest, stress[k]);
    const double volumetric = m_lambda * (1.0 - std::log(J[p])) / J[p];
    const double stretch = J[p] * largest / m_mu + 1.0;  // at least the largest b_kk
    modulus[p] = volumetric + m_mu / J[p] * (1.0 + stretch);
  }
}

/// With mu (tr b - 3) = J tr sigma - 3 lambda ln J.
void NeoHookean::strain_energy_density(const Batch& batch, std::span<double> density) const {
  const double* J = batch.state[0];
  for (std::size_t p = 0; p < batch.size; ++p) {
    const double log_J = std::log(J[p]);
    density[p] =
        0.5 * trace(batch.stress.load(p)) + log_J * (0.5 * m_lambda * (log_J - 3.0) - m_mu) / J[p];
  }
}

void NeoHookean::initialise_from_stress(const Batch& /*batch*/) const {
  throw BadInput("the neo-Hookean law cannot start from a prescribed stress");
}

}  // namespace mpm::material
