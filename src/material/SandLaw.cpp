#include "mpm/material/SandLaw.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "SandIntegrator.hpp"
#include "SandPack.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/material/PackTensor.hpp"

namespace mpm::material {

namespace {

using simd::Pack;

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
      m_gap(sand),
      m_cohesion_shift(material::cohesion_shift(sand)),
      m_state_variables{
          {"void_ratio", "void ratio of the skeleton", "1", sand.void_ratio, StateRole::softening},
          {"eps_q", "deviatoric strain measure of the loading surface, grows when plastic", "1",
           0.0, StateRole::softening},
          {"gap_volume_ratio", "volume ratio of gaps opened at the pressure floor", "1", 1.0}} {}

double SandLaw::initial_density() const {
  return m_sand.Gs * 1000.0 / (1.0 + m_sand.void_ratio);
}

namespace {

/// Takes the mean off in place and returns the trace.
Pack make_deviator(PackTensor& a) {
  const Pack sum = trace(a);
  for (int k = 0; k < 3; ++k) a[k] -= sum * (1.0 / 3.0);
  return sum;
}

Shear shear_of(const Batch& batch) {
  for (std::size_t k : {4U, 5U})
    if (batch.stress.component[k] || batch.strain_increment.component[k]) return Shear::any;
  return Shear::in_plane;
}

/// Some particles of a batch as packs: their deviators, and what becomes of them.
class SandBlock {
 public:
  SandBlock(const Batch& batch, double cohesion_shift)
      : m_batch(batch), m_cohesion_shift(cohesion_shift), m_shear(shear_of(batch)) {}

  /// Moves to the particles from `first` on.
  void load(std::size_t first) {
    m_first = first;
    m_size = std::min(block, (m_batch.size - first + simd::lanes - 1) / simd::lanes);
    for (std::size_t k = 0; k < m_size; ++k) load_pack(k);
  }
  void advance(const SandPackIntegrator& integrator) {
    integrator.advance({m_start.data(), m_size}, {m_end.data(), m_size});
  }
  /// Calls `leave(particle)` for those that have not been advanced.
  template <class Leave>
  void store(const Leave& leave) {
    for (std::size_t k = 0; k < m_size; ++k) {
      store_pack(k);
      if (simd::all(m_end[k].done)) continue;
      for (std::size_t lane = 0; lane < std::min<std::size_t>(simd::lanes, count(k)); ++lane)
        if (!m_end[k].done[lane]) leave(particle(k) + lane);
    }
  }

 private:
  static constexpr std::size_t block = SandPackIntegrator::block;

  std::size_t particle(std::size_t k) const { return m_first + k * simd::lanes; }
  std::size_t count(std::size_t k) const { return m_batch.size - particle(k); }
  const double* state(std::size_t variable, std::size_t k) const {
    return m_batch.state[variable] + particle(k);
  }

  void load_pack(std::size_t k) {
    SandPack& y = m_start[k];
    m_stress[k] = load_lanes(m_batch.stress, particle(k), count(k));
    m_s[k] = m_stress[k];
    m_e[k] = load_lanes(m_batch.strain_increment, particle(k), count(k));
    y.p_star = m_cohesion_shift - make_deviator(m_s[k]) * (1.0 / 3.0);
    y.deps_v = -make_deviator(m_e[k]);
    m_void_ratio[k] = load_lanes(state(SandLaw::void_ratio, k), count(k));
    y.specific_volume = 1.0 + m_void_ratio[k];
    y.eps_q = load_lanes(state(SandLaw::eps_q, k), count(k));
    y.gap = load_lanes(state(SandLaw::gap_volume_ratio, k), count(k));
    y.plane = plane_of(m_s[k], m_e[k], m_shear);
  }

  /// Lanes that are not done get back what they had.
  void store_pack(std::size_t k) const {
    const auto& [p_star, eps_q, specific_volume, a, b, done] = m_end[k];
    PackTensor stress;
    for (int c = 0; c < SymmetricTensor::size; ++c) stress[c] = a * m_s[k][c] + b * m_e[k][c];
    for (int c = 0; c < 3; ++c) stress[c] += m_cohesion_shift - p_star;
    for (int c = 0; c < SymmetricTensor::size; ++c)
      stress[c] = simd::select(done, stress[c], m_stress[k][c]);
    store_lanes(m_batch.stress, particle(k), count(k), stress);
    store_lanes(m_batch.state[SandLaw::void_ratio] + particle(k),
                simd::select(done, specific_volume - 1.0, m_void_ratio[k]), count(k));
    store_lanes(m_batch.state[SandLaw::eps_q] + particle(k),
                simd::select(done, eps_q, m_start[k].eps_q), count(k));
  }

  const Batch& m_batch;
  double m_cohesion_shift;
  Shear m_shear;
  std::size_t m_first = 0, m_size = 0;
  std::array<PackTensor, block> m_stress, m_s, m_e;
  std::array<Pack, block> m_void_ratio;
  std::array<SandPack, block> m_start;
  std::array<SandPackEnd, block> m_end;
};

}  // namespace

void SandLaw::update_stress(const Batch& batch) const {
  const SandPackIntegrator integrator(m_surface, m_sand);
  SandBlock particles(batch, m_cohesion_shift);
  for (std::size_t p = 0; p < batch.size; p += SandPackIntegrator::block * simd::lanes) {
    particles.load(p);
    particles.advance(integrator);
    particles.store([&](std::size_t left) { update_alone(batch, left); });
  }
}

void SandLaw::update_alone(const Batch& batch, std::size_t i) const {
  const SandIntegrator integrator(m_surface, m_gap, m_sand);
  double& e = batch.state[void_ratio][i];
  double& eps = batch.state[eps_q][i];
  double& gap = batch.state[gap_volume_ratio][i];
  const SymmetricTensor stress = batch.stress.load(i);
  const SymmetricTensor strain = batch.strain_increment.load(i);
  SandPoint y{m_cohesion_shift - trace(stress) / 3.0, deviator(stress), eps, 1.0 + e, gap};
  const bool integrated = integrator.advance(y, {-trace(strain), deviator(strain)});
  e = y.specific_volume - 1.0;
  eps = y.eps_q;
  gap = y.gap;
  batch.stress.store(
      i, integrated ? total_stress(y.s, y.p_star - m_cohesion_shift) : not_integrable());
}

void SandLaw::wave_modulus(const Batch& batch, std::span<double> modulus) const {
  const SandElasticity& elasticity = m_surface.elasticity();
  for (std::size_t first = 0; first < batch.size; first += simd::lanes) {
    const std::size_t count = batch.size - first;
    const Pack pressure = trace(load_lanes(batch.stress, first, count)) * (-1.0 / 3.0);
    const Pack p_star =
        simd::max(m_cohesion_shift + pressure, simd::broadcast(m_sand.pressure_floor));
    store_lanes(&modulus[first],
                elasticity.bulk_modulus(p_star) + 4.0 / 3.0 * elasticity.shear_modulus(p_star),
                count);
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
    const bool at_floor =
        p_star <= m_sand.pressure_floor * (1.0 + 1e-9) || batch.state[gap_volume_ratio][i] > 1.0;
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
