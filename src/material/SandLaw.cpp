#include "mpm/material/SandLaw.hpp"

#include <fmt/format.h>

#include <algorithm>
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
      m_cohesion_shift(material::cohesion_shift(sand)),
      m_state_variables{
          {"void_ratio", "void ratio of the skeleton", "1", sand.void_ratio},
          {"eps_q", "deviatoric strain measure of the loading surface, grows when plastic", "1",
           0.0},
          {"gap_volume_ratio", "volume ratio of gaps opened at the pressure floor", "1", 1.0}} {}

double SandLaw::initial_density() const {
  return m_sand.Gs * 1000.0 / (1.0 + m_sand.void_ratio);
}

namespace {

/// s (and e) of four particles without their components yz and xz where those are zero for all.
/// Takes the mean off in place and returns the trace.
Pack make_deviator(PackTensor& a) {
  const Pack sum = trace(a);
  for (int k = 0; k < 3; ++k) a[k] -= sum * (1.0 / 3.0);
  return sum;
}

DeviatorPlane plane_of(const PackTensor& s, const PackTensor& e, bool plane_strain) {
  const auto square = [&](const PackTensor& a, const PackTensor& b) {
    Pack sum = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + 2.0 * (a[3] * b[3]);
    if (!plane_strain) sum += 2.0 * (a[4] * b[4] + a[5] * b[5]);
    return sum;
  };
  DeviatorPlane d{square(s, s), square(s, e), square(e, e), {}, {}, {}, {}};
  // cof(a) : b and det a = cof(a) : a/3.
  const auto add = [&](const PackTensor& a, Pack& with_itself, const PackTensor& b, Pack& with_b) {
    PackTensor cof;
    cof[0] = a[1] * a[2];
    cof[1] = a[0] * a[2];
    cof[2] = a[0] * a[1] - a[3] * a[3];
    cof[3] = -a[3] * a[2];
    if (!plane_strain) {
      cof[0] -= a[4] * a[4];
      cof[1] -= a[5] * a[5];
      cof[3] += a[4] * a[5];
      cof[4] = a[3] * a[5] - a[4] * a[0];
      cof[5] = a[3] * a[4] - a[1] * a[5];
    }
    with_b = square(cof, b);
    with_itself = a[0] * cof[0] + a[3] * cof[3];
    if (!plane_strain) with_itself += a[5] * cof[5];
  };
  add(s, d.det_s, e, d.turn_s);
  add(e, d.det_e, s, d.turn_e);
  return d;
}

}  // namespace

void SandLaw::update_stress(const Batch& batch) const {
  const SandPackIntegrator integrator(m_surface, m_sand);
  double* const e = batch.state[void_ratio];
  double* const eps = batch.state[eps_q];
  const double* const gap = batch.state[gap_volume_ratio];
  const bool plane_strain =
      batch.stress.component[4] == nullptr && batch.strain_increment.component[4] == nullptr &&
      batch.stress.component[5] == nullptr && batch.strain_increment.component[5] == nullptr;
  for (std::size_t first = 0; first < batch.size; first += simd::lanes) {
    const std::size_t count = batch.size - first;
    const PackTensor stress = load_lanes(batch.stress, first, count);
    PackTensor s = stress, strain = load_lanes(batch.strain_increment, first, count);
    const Pack void_ratio_0 = load_lanes(e + first, count), eps_0 = load_lanes(eps + first, count);
    SandPack y;
    y.p_star = m_cohesion_shift - make_deviator(s) * (1.0 / 3.0);
    y.deps_v = -make_deviator(strain);
    y.specific_volume = 1.0 + void_ratio_0;
    y.eps_q = eps_0;
    y.gap = load_lanes(gap + first, count);
    y.plane = plane_of(s, strain, plane_strain);
    SandPackEnd end;
    integrator.advance(y, end);
    PackTensor new_stress;
    const Pack mean = m_cohesion_shift - end.p_star;
    for (int k = 0; k < SymmetricTensor::size; ++k) {
      new_stress[k] = end.of_stress * s[k] + end.of_strain * strain[k];
      if (k < 3) new_stress[k] += mean;
      new_stress[k] = simd::select(end.done, new_stress[k], stress[k]);
    }
    store_lanes(batch.stress, first, count, new_stress);
    store_lanes(e + first, simd::select(end.done, end.specific_volume - 1.0, void_ratio_0), count);
    store_lanes(eps + first, simd::select(end.done, end.eps_q, eps_0), count);
    if (simd::all(end.done)) continue;
    for (std::size_t lane = 0; lane < simd::lanes && lane < count; ++lane)
      if (!end.done[lane]) update_alone(batch, first + lane);
  }
}

void SandLaw::update_alone(const Batch& batch, std::size_t i) const {
  const SandIntegrator integrator(m_surface, m_sand);
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
