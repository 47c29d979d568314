#include "SandIntegrator.hpp"

#include <algorithm>
#include <cmath>

#include "SandFlow.hpp"

namespace mpm::material {

namespace {

constexpr int max_passes = 10'000;       // ten are usual; a few milliseconds
constexpr double smallest_part = 1e-12;  // of the increment

double deviatoric_stress(const SymmetricTensor& s) {
  return std::sqrt(1.5 * contract(s, s));
}

/// cof(a) : b, the derivative of det(a) along b.
double cofactor_contract(const SymmetricTensor& a, const SymmetricTensor& b) {
  const auto& [xx, yy, zz, xy, yz, xz] = a.components;
  return (yy * zz - yz * yz) * b[0] + (xx * zz - xz * xz) * b[1] + (xx * yy - xy * xy) * b[2] +
         2.0 *
             ((yz * xz - xy * zz) * b[3] + (xy * xz - yz * xx) * b[4] + (xy * yz - yy * xz) * b[5]);
}

SandPoint moved(const SandPoint& y, double p_star, const SymmetricTensor& s, double eps_q,
                double volume_ratio) {
  return {p_star, y.s + s, eps_q, y.specific_volume * volume_ratio, y.gap};
}

}  // namespace

bool SandIntegrator::advance(SandPoint& y, SandStrain d) const {
  if (y.p_star < m_floor || y.gap > 1.0) drop_to_floor(y);
  close_gap(y, d);
  const bool integrated = advance_skeleton(y, d);
  if (y.gap > 1.0) y.p_star = m_gap.p_star(y.gap);
  return integrated;
}

/// A gap that is open has no part in it but to open further.
bool SandIntegrator::advance_skeleton(SandPoint& y, const SandStrain& d) const {
  Progress progress;
  for (int pass = 0; pass < max_passes && progress.remaining > smallest_part; ++pass) {
    if (at_floor(y) && d.volumetric <= 0.0) {
      drop_to_floor(y);
      y.gap *= std::exp(-progress.remaining * d.volumetric);
      return true;
    }
    const View v = view(y, d);
    if (!is_on_surface(v) && elastic_step(y, d, progress)) continue;
    const Rates k1 = rates(v, d);
    if (!k1.loading && elastic_step(y, d, progress)) continue;
    if (!plastic_step(y, d, k1, progress)) return false;
  }
  return progress.remaining <= smallest_part;
}

void SandIntegrator::drop_to_floor(SandPoint& y) const {
  y.p_star = m_floor;
  y.s = {};
}

void SandIntegrator::close_gap(SandPoint& y, SandStrain& d) const {
  if (!(y.gap > 1.0) || !(d.volumetric > 0.0)) return;
  const double opening = std::log(y.gap);
  if (opening >= d.volumetric) {
    y.gap = std::max(1.0, y.gap * std::exp(-d.volumetric));
    d = {};
    return;
  }
  y.gap = 1.0;
  d.deviatoric *= 1.0 - opening / d.volumetric;
  d.volumetric -= opening;
}

SandIntegrator::View SandIntegrator::view(const SandPoint& y, const SandStrain& d) const {
  View v;
  v.q = deviatoric_stress(y.s);
  v.has_direction = v.q > vanishing_ratio * y.p_star;
  if (v.has_direction) {
    v.direction = (1.0 / v.q) * y.s;
  } else {
    const double size = deviatoric_stress(d.deviatoric);
    v.direction = size > 0.0 ? (1.0 / size) * d.deviatoric : SymmetricTensor{};
  }
  const double sin3theta = std::clamp(13.5 * determinant(v.direction), -1.0, 1.0);
  v.arguments = {y.p_star, y.specific_volume - 1.0, y.eps_q, sin3theta};
  v.point = m_surface.at(v.arguments);
  return v;
}

bool SandIntegrator::is_on_surface(const View& v) const {
  return v.q >= v.point.qhat - surface_tolerance * v.arguments.p_star;
}

/// How far q lies above the surface.
double SandIntegrator::excess(const SandPoint& y, const SandStrain& d) const {
  const View v = view(y, d);
  return v.q - v.point.qhat;
}

/// dsin3theta by the elastic stress increment; the plastic one is radial and turns nothing.
double SandIntegrator::lode_rate(const View& v, const SandStrain& d, double deps_q) const {
  if (!v.has_direction) return 0.0;
  const double turn = 27.0 * cofactor_contract(v.direction, d.deviatoric);
  return v.point.G / v.q * (turn - 9.0 * v.arguments.sin3theta * deps_q);
}

/// The increments that follow from Eq. 23, for the whole strain increment.
SandIntegrator::Rates SandIntegrator::rates(const View& v, const SandStrain& d) const {
  const double deps_q = contract(v.direction, d.deviatoric);
  const SandFlow<double> flow = sand_flow(m_surface, v.arguments, v.point, v.q,
                                          {d.volumetric, deps_q, lode_rate(v, d, deps_q)});
  const double G = v.point.G;
  return {flow.p_star, 2.0 * G * d.deviatoric + (-3.0 * G * flow.lambda) * v.direction, flow.eps_q,
          flow.loading};
}

SandPoint SandIntegrator::elastic_path(const SandPoint& y, const SandStrain& d, double part) const {
  const double deps_v = part * d.volumetric;
  const auto end = m_surface.elasticity().follow(y.p_star, deps_v);
  return moved(y, end.p_star, (2.0 * end.mean_shear_modulus * part) * d.deviatoric, y.eps_q,
               std::exp(-deps_v));
}

/// Part of the increment after which an elastic path is checked against the surface, at most up to
/// the pressure floor.
double SandIntegrator::elastic_part(const SandPoint& y, const SandStrain& d,
                                    double remaining) const {
  const SandElasticity& elasticity = m_surface.elasticity();
  const double stress_change =
      elasticity.bulk_modulus(y.p_star) * std::abs(d.volumetric) +
      2.0 * elasticity.shear_modulus(y.p_star) * deviatoric_stress(d.deviatoric);
  double part = remaining;
  if (stress_change * part > largest_elastic_part * y.p_star)
    part = largest_elastic_part * y.p_star / stress_change;
  if (d.volumetric < 0.0)
    part = std::min(part, elasticity.strain_to_pressure(y.p_star, m_floor) / d.volumetric);
  return part;
}

/// Part at which the elastic path, outside the surface at `end`, leaves it; 0 if it was never
/// inside. Illinois variant of the false position.
double SandIntegrator::crossing(const SandPoint& y, const SandStrain& d, double end) const {
  const double tolerance = 1e-10 * y.p_star;
  double high = end, above = excess(elastic_path(y, d, end), d);
  double low = 0.0, below = excess(y, d);
  for (double part = 0.5 * end; !(below < -tolerance); part *= 0.5) {
    if (!(part > smallest_part * end)) return 0.0;
    below = excess(elastic_path(y, d, part), d);
    if (below < -tolerance) low = part;
  }
  for (int iteration = 0; iteration < 100; ++iteration) {
    const double part = (low * above - high * below) / (above - below);
    const double value = excess(elastic_path(y, d, part), d);
    if (std::abs(value) <= tolerance) return part;
    if (value > 0.0) {
      high = part;
      above = value;
      below *= 0.5;
    } else {
      low = part;
      below = value;
      above *= 0.5;
    }
  }
  return low;
}

/// Moves along the elastic path up to the surface or the floor. False if it leads straight out.
bool SandIntegrator::elastic_step(SandPoint& y, const SandStrain& d, Progress& progress) const {
  double part = elastic_part(y, d, progress.remaining);
  SandPoint end = elastic_path(y, d, part);
  if (excess(end, d) > 0.5 * surface_tolerance * end.p_star) {
    part = crossing(y, d, part);
    if (part <= 0.0) return false;
    end = elastic_path(y, d, part);
  }
  y = end;
  progress.remaining -= part;
  if (at_floor(y)) drop_to_floor(y);
  return true;
}

/// Modified Euler over a part of the increment, and its distance from Euler relative to the stress.
SandIntegrator::Trial SandIntegrator::modified_euler(const SandPoint& y, const SandStrain& d,
                                                     const Rates& k1, double part) const {
  const double volume_ratio = std::exp(-part * d.volumetric);
  const SandPoint euler =
      moved(y, y.p_star + part * k1.p_star, part * k1.s, y.eps_q + part * k1.eps_q, volume_ratio);
  const Rates k2 = rates(view(euler, d), d);
  const double half = 0.5 * part;
  const SandPoint end = moved(y, y.p_star + half * (k1.p_star + k2.p_star), half * (k1.s + k2.s),
                              y.eps_q + half * (k1.eps_q + k2.eps_q), volume_ratio);
  const SymmetricTensor ds = half * (k2.s + (-1.0) * k1.s);
  const double dp = half * (k2.p_star - k1.p_star);
  return {end, std::sqrt((contract(ds, ds) + 3.0 * dp * dp) /
                         (contract(end.s, end.s) + 3.0 * end.p_star * end.p_star))};
}

/// One accepted substep.
bool SandIntegrator::plastic_step(SandPoint& y, const SandStrain& d, const Rates& k1,
                                  Progress& progress) const {
  while (progress.substep > smallest_part) {
    const double part = std::min(progress.substep, progress.remaining);
    if (y.p_star + part * k1.p_star < 0.5 * y.p_star) {
      progress.substep = 0.25 * part;
      continue;
    }
    Trial trial = modified_euler(y, d, k1, part);
    if (!std::isfinite(trial.error)) return false;
    const double factor = std::clamp(0.9 * std::sqrt(m_tolerance / trial.error), 0.1, 2.0);
    progress.substep = std::min(1.0, factor * part);
    if (trial.error > m_tolerance) continue;
    if (trial.end.p_star <= m_floor) {
      stop_at_floor(y, trial.end, d, part, progress);
    } else {
      return_to_surface(trial.end, d);
      y = trial.end;
      progress.remaining -= part;
    }
    return true;
  }
  return false;
}

void SandIntegrator::stop_at_floor(SandPoint& y, const SandPoint& end, const SandStrain& d,
                                   double part, Progress& progress) const {
  double share = 1.0;
  if (!at_floor(y)) share = (y.p_star - m_floor) / (y.p_star - end.p_star);
  y.eps_q += share * (end.eps_q - y.eps_q);
  y.specific_volume *= std::exp(-share * part * d.volumetric);
  drop_to_floor(y);
  progress.remaining -= share * part;
}

/// Radial return at constant p, which leaves qhat unchanged and is exact in one go.
void SandIntegrator::return_to_surface(SandPoint& y, const SandStrain& d) const {
  // Substeps that are long for 3G/q multiply the round-off in tr s, which no error measure sees.
  if (std::abs(trace(y.s)) > surface_tolerance * y.p_star) y.s = deviator(y.s);
  const View v = view(y, d);
  if (v.has_direction) y.s *= v.point.qhat / v.q;
}

}  // namespace mpm::material
