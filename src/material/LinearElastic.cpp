#include "mpm/material/LinearElastic.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "mpm/core/Errors.hpp"
#include "mpm/material/PackTensor.hpp"

namespace mpm::material {

LinearElastic::LinearElastic(const LinearElasticParameters& parameters, std::string_view prefix)
    : m_density(parameters.density) {
  const auto [E, nu, density] = parameters;
  if (!(E > 0.0)) throw BadInput(fmt::format("-{}_youngs_modulus {}: must be positive", prefix, E));
  if (!(nu > -1.0 && nu < 0.5))
    throw BadInput(fmt::format("-{}_poisson_ratio {}: must be above -1 and below 0.5", prefix, nu));
  if (!(density > 0.0))
    throw BadInput(fmt::format("-{}_density {}: must be positive", prefix, density));
  m_lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  m_mu = 0.5 * E / (1.0 + nu);
}

void LinearElastic::update_stress(const Batch& batch) const {
  for (std::size_t p = 0; p < batch.size; p += simd::lanes) {
    const std::size_t count = batch.size - p;
    store_lanes(batch.stress, p, count, trial_stress(batch, p, count));
  }
}

void LinearElastic::wave_modulus(const Batch& batch, std::span<double> modulus) const {
  std::fill_n(modulus.begin(), batch.size, m_lambda + 2.0 * m_mu);
}

void LinearElastic::strain_energy_density(const Batch& batch, std::span<double> density) const {
  for (std::size_t p = 0; p < batch.size; ++p)
    density[p] = strain_energy_density(batch.stress.load(p));
}

}  // namespace mpm::material
