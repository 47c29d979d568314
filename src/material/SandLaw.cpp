#include "mpm/material/SandLaw.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "SandIntegrator.hpp"
#include "mpm/core/Errors.hpp"

namespace mpm::material {

namespace {

const SandParameters& validated(const SandParameters& sand) {
  validate(sand);
  return sand;
}

SymmetricTensor total_stress(const SymmetricTensor& s, double p) {
  SymmetricTensor stress = s;
  for (int k = 0; k < 3; ++k) stress[k] -= p;
  return stress;
}

SymmetricTensor not_integrable() {
  SymmetricTensor stress;
  stress.components.fill(std::numeric_limits<double>::quiet_NaN());
  return stress;
}

}  // namespace

SandLaw::SandLaw(const SandParameters& sand)
    : m_sand(validated(sand)),
      m_surface(sand),
      m_cohesion_shift(material::cohesion_shift(sand)),
      m_state_variables{
          {"void_ratio", "void ratio of the skeleton", "1", sand.void_ratio},
          {"eps_q", "deviatoric strain measure of the loading surface, grows when plastic", "1",
           0.0},
          {"gap_volume_ratio", "volume ratio of gaps opened at the pressure floor", "1", 1.0}} {}

double SandLaw::initial_density() const {
  return m_sand.Gs * 1000.0 / (1.0 + m_sand.void_ratio);
}

void SandLaw::update_stress(const Batch& batch) const {
  const SandIntegrator integrator(m_surface, m_sand);
  double* const e = batch.state[void_ratio];
  double* const eps = batch.state[eps_q];
  double* const gap = batch.state[gap_volume_ratio];
  for (std::size_t i = 0; i < batch.size; ++i) {
    const SymmetricTensor stress = batch.stress.load(i);
    const SymmetricTensor strain = batch.strain_increment.load(i);
    SandPoint y{m_cohesion_shift - trace(stress) / 3.0, deviator(stress), eps[i], 1.0 + e[i],
                gap[i]};
    const bool integrated = integrator.advance(y, {-trace(strain), deviator(strain)});
    e[i] = y.specific_volume - 1.0;
    eps[i] = y.eps_q;
    gap[i] = y.gap;
    batch.stress.store(
        i, integrated ? total_stress(y.s, y.p_star - m_cohesion_shift) : not_integrable());
  }
}

void SandLaw::wave_modulus(const Batch& batch, std::span<double> modulus) const {
  const SandElasticity& elasticity = m_surface.elasticity();
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double p_star = std::max(invariants(batch.stress.load(i)).p_star, m_sand.pressure_floor);
    modulus[i] = elasticity.bulk_modulus(p_star) + 4.0 / 3.0 * elasticity.shear_modulus(p_star);
  }
}

SandInvariants SandLaw::invariants(const SymmetricTensor& stress) const {
  const SymmetricTensor s = deviator(stress);
  const double q = std::sqrt(1.5 * contract(s, s));
  const double p_star = m_cohesion_shift - trace(stress) / 3.0;
  if (!(q > 1e-9 * std::abs(p_star))) return {p_star, q, 0.0};
  return {p_star, q, std::clamp(13.5 * determinant((1.0 / q) * s), -1.0, 1.0)};
}

std::size_t SandLaw::count_at_limits(const Batch& batch) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < batch.size; ++i) {
    const double p_star = invariants(batch.stress.load(i)).p_star;
    const bool at_floor = p_star <= m_sand.pressure_floor * (1.0 + 1e-9);
    const double psi = batch.state[void_ratio][i] -
                       m_surface.critical_void_ratio(std::max(p_star, m_sand.pressure_floor));
    if (at_floor || psi >= m_sand.psi_cap) ++count;
  }
  return count;
}

void SandLaw::initialise_from_stress(const Batch& batch) const {
  for (std::size_t i = 0; i < batch.size; ++i) {
    const SandInvariants stress = invariants(batch.stress.load(i));
    batch.state[void_ratio][i] = m_sand.void_ratio;
    batch.state[gap_volume_ratio][i] = 1.0;
    batch.state[eps_q][i] = strain_on_surface(
        {std::max(stress.p_star, m_sand.pressure_floor), m_sand.void_ratio, 0.0, stress.sin3theta},
        stress.q);
  }
}

namespace {

double qhat_at(const LoadingSurface& surface, SurfaceState y, double eps_q) {
  y.eps_q = eps_q;
  return surface.at(y).qhat;
}

/// Root of qhat = q between `low` (below q) and `high` (at or above q), to the last digit.
double bisect(const LoadingSurface& surface, const SurfaceState& y, double q, double low,
              double high) {
  for (int iteration = 0; iteration < 200; ++iteration) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (qhat_at(surface, y, middle) < q ? low : high) = middle;
  }
  return high;
}

}  // namespace

double SandLaw::strain_on_surface(SurfaceState y, double q) const {
  if (!(q > 1e-9 * y.p_star)) return 0.0;
  constexpr double step = 1.05;
  double low = 0.0;
  double largest = 0.0;
  for (double high = 1e-10; high < 100.0 * m_sand.eps_r; low = high, high *= step) {
    const double qhat = qhat_at(m_surface, y, high);
    if (qhat >= q) return bisect(m_surface, y, q, low, high);
    largest = std::max(largest, qhat);
  }
  const double p = y.p_star - m_cohesion_shift;
  throw BadInput(fmt::format(
      "initial stress q = {:.6g} Pa at p = {:.6g} Pa (q/p = {:.4g}): the sand carries at most "
      "q/p = {:.4g} there; bring -K0 closer to 1 or use a denser sand",
      q, p, q / p, largest / p));
}

}  // namespace mpm::material
