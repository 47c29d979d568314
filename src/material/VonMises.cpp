#include "mpm/material/VonMises.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mpm/core/Errors.hpp"
#include "mpm/material/PackTensor.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {
namespace {

double equivalent_stress(const SymmetricTensor& s) {
  return std::sqrt(1.5 * contract(s, s));
}

}  // namespace

VonMises::VonMises(const VonMisesParameters& parameters)
    : m_elastic(parameters.elastic, "von_mises"),
      m_shear_strength(parameters.shear_strength),
      m_yield_stress(std::numbers::sqrt3 * parameters.shear_strength) {
  if (!(m_shear_strength > 0.0))
    throw BadInput(fmt::format("-von_mises_shear_strength {}: must be positive", m_shear_strength));
}

std::span<const StateVariable> VonMises::state_variables() const {
  static const std::array<StateVariable, 1> variables{
      {{"plastic_strain", "accumulated plastic deviatoric strain, grows only", "1", 0.0}}};
  return variables;
}

void VonMises::update_stress(const Batch& batch) const {
  const double G3 = 3.0 * m_elastic.shear_modulus();
  for (std::size_t p = 0; p < batch.size; p += simd::lanes) {
    const std::size_t count = batch.size - p;
    PackTensor stress = m_elastic.trial_stress(batch, p, count);
    PackTensor s = stress;
    const simd::Pack mean = trace(stress) * (1.0 / 3.0);
    for (int k = 0; k < 3; ++k) s[k] -= mean;
    const simd::Pack q = simd::sqrt(1.5 * contract(s, s));
    const simd::Mask yields = q > m_yield_stress;
    if (simd::any(yields)) {
      const simd::Pack part = simd::select(yields, m_yield_stress / q - 1.0, simd::Pack{});
      for (int k = 0; k < SymmetricTensor::size; ++k) stress[k] += part * s[k];
      double* const plastic_strain = batch.state[0] + p;
      const simd::Pack more = simd::select(yields, (q - m_yield_stress) / G3, simd::Pack{});
      store_lanes(plastic_strain, load_lanes(plastic_strain, count) + more, count);
    }
    store_lanes(batch.stress, p, count, stress);
  }
}

void VonMises::wave_modulus(const Batch& batch, std::span<double> modulus) const {
  m_elastic.wave_modulus(batch, modulus);
}

void VonMises::initialise_from_stress(const Batch& batch) const {
  for (std::size_t p = 0; p < batch.size; ++p) {
    const double q = equivalent_stress(deviator(batch.stress.load(p)));
    if (!(q <= m_yield_stress * (1.0 + 1e-9)))
      throw BadInput(fmt::format(
          "-von_mises_shear_strength {}: the initial stress has q = {:.6g} Pa and at most "
          "sqrt(3) times the strength, {:.6g} Pa, is allowed; start from a more even stress or "
          "raise the strength",
          m_shear_strength, q, m_yield_stress));
    batch.state[0][p] = 0.0;
  }
}

void VonMisesFactory::declare(options::OptionSet& set) {
  set.section("Von Mises material");
  declare_linear_elastic(set, "von_mises", m_parameters.elastic);
  set.real("von_mises_shear_strength", m_parameters.shear_strength, options::positive(),
           {"Pa", "Undrained shear strength c, reached in simple shear; q is at most sqrt(3) c.",
            "chosen: see docs/model.md"});
}

std::unique_ptr<Material> VonMisesFactory::create() const {
  return std::make_unique<VonMises>(m_parameters);
}

}  // namespace mpm::material
