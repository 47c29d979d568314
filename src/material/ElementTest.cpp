#include "mpm/material/ElementTest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mpm/core/Errors.hpp"

namespace mpm::material {

namespace {

constexpr int size = SymmetricTensor::size;
constexpr int xx = 0, yy = 1, zz = 2, xy = 3;

constexpr double largest_strain_step = 1e-4;
constexpr double largest_stress_step = 2e-3;    // of the present stress
constexpr double stress_tolerance = 1e-9;       // of the present stress
constexpr double largest_strain_sought = 0.05;  // of a stress-controlled component in a step
constexpr int largest_number_of_halvings = 12;
constexpr int clean_parts_to_coarsen = 4;
constexpr long long largest_number_of_responses = 1'000'000;  // of an increment; 100 are usual

bool is_stress(const MixedIncrement& increment, int k) {
  return increment.control[static_cast<std::size_t>(k)] == Control::stress;
}

/// Solves a x = b by elimination with row pivoting.
SymmetricTensor solve_linear(std::array<SymmetricTensor, size> a, SymmetricTensor b) {
  const auto row = [&a](int k) -> SymmetricTensor& { return a[static_cast<std::size_t>(k)]; };
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    for (int i = k + 1; i < size; ++i)
      if (std::abs(row(i)[k]) > std::abs(row(pivot)[k])) pivot = i;
    std::swap(row(k), row(pivot));
    std::swap(b[k], b[pivot]);
    for (int i = k + 1; i < size; ++i) {
      const double factor = row(i)[k] / row(k)[k];
      for (int j = k; j < size; ++j) row(i)[j] -= factor * row(k)[j];
      b[i] -= factor * b[k];
    }
  }
  for (int k = size - 1; k >= 0; --k) {
    for (int j = k + 1; j < size; ++j) b[k] -= row(k)[j] * b[j];
    b[k] /= row(k)[k];
  }
  return b;
}

Batch one_particle(const SymmetricTensor& strain, SymmetricTensor& stress,
                   std::vector<double>& state) {
  Batch batch;
  batch.size = 1;
  for (std::size_t k = 0; k < size; ++k) {
    batch.strain_increment.component[k] = &strain.components[k];
    batch.stress.component[k] = &stress.components[k];
  }
  for (double& value : state) batch.state.push_back(&value);
  return batch;
}

}  // namespace

MaterialPoint::MaterialPoint(const Material& material, double pressure) : m_material(material) {
  for (int k = 0; k < 3; ++k) m_stress[k] = -pressure;
  for (const StateVariable& variable : material.state_variables())
    m_state.push_back(variable.initial);
  material.initialise_from_stress(one_particle(m_strain, m_stress, m_state));
  const double start = norm(m_stress + (-1.0) * respond({}).stress);
  if (!(start <= stress_tolerance * norm(m_stress)))
    throw BadInput(fmt::format(
        "-confining_pressure {}: the material does not stay at rest under it; allowed: a larger "
        "pressure (sand without cohesion: at least -sand_pressure_floor)",
        pressure));
}

std::optional<double> MaterialPoint::state(std::string_view name) const {
  const auto variables = m_material.state_variables();
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (variables[k].name == name) return m_state[k];
  return std::nullopt;
}

double MaterialPoint::number_of_steps(const MixedIncrement& increment) const {
  const double stress_step = largest_stress_step * norm(m_stress);
  double steps = 1.0;
  for (int k = 0; k < size; ++k) {
    const double limit = is_stress(increment, k) ? stress_step : largest_strain_step;
    if (limit > 0.0) steps = std::max(steps, std::ceil(std::abs(increment.change[k]) / limit));
  }
  return steps;
}

/// A part that had to be halved tells how finely the next ones are taken from the start; where the
/// law is stiff for its stress, trying in full each time would cost minutes.
void MaterialPoint::apply(const MixedIncrement& increment) {
  const double steps = number_of_steps(increment);
  m_responses = 0;
  MixedIncrement part = increment;
  part.change *= 1.0 / steps;
  for (double k = 0.0; k < steps; k += 1.0) {
    const int before = m_halvings;
    step(part, 0);
    m_clean_parts = m_halvings == before ? m_clean_parts + 1 : 0;
    if (m_halvings == 0 || m_clean_parts < clean_parts_to_coarsen) continue;
    --m_halvings;
    m_clean_parts = 0;
  }
}

void MaterialPoint::step(const MixedIncrement& increment, int halvings) {
  if (halvings >= m_halvings && (solve(increment, false) || solve(increment, true))) return;
  if (halvings == largest_number_of_halvings) fail("the material may have lost its strength");
  m_halvings = std::max(m_halvings, halvings + 1);
  MixedIncrement half = increment;
  half.change *= 0.5;
  m_last_step *= 0.5;
  step(half, halvings + 1);
  step(half, halvings + 1);
}

void MaterialPoint::fail(const char* reason) const {
  throw NumericalFailure(
      fmt::format("element test: no strain found for the prescribed stress at strain "
                  "({:.6g}, {:.6g}, {:.6g}) and mean pressure {:.6g} Pa; {}",
                  m_strain[xx], m_strain[yy], m_strain[zz], -trace(m_stress) / 3.0, reason),
      failure_kind("law_cannot_follow",
                   "a larger -confining_pressure, more -increments, or less -strain_end"));
}

/// Newton iteration for the strains of the stress-controlled components, by default with the
/// tangent of an earlier step.
bool MaterialPoint::solve(const MixedIncrement& increment, bool renew_tangent) {
  SymmetricTensor strain = first_guess(increment);
  const SymmetricTensor start = m_stress;
  for (int iteration = 0; iteration < 15; ++iteration) {
    if (++m_responses > largest_number_of_responses)
      fail("the law takes too many steps, its stiffness is too large for its stress");
    Response response = respond(strain);
    const SymmetricTensor error = misfit(increment, start, response.stress);
    const double size_of_error = norm(error);
    if (!std::isfinite(size_of_error)) return false;
    if (size_of_error <= stress_tolerance * norm(response.stress)) {
      m_stress = response.stress;
      m_state = std::move(response.state);
      m_strain += strain;
      m_last_step = strain;
      return true;
    }
    if (renew_tangent) m_tangent = tangent(increment, strain);
    const SymmetricTensor correction = solve_linear(m_tangent, error);
    for (int k = 0; k < size; ++k)
      if (is_stress(increment, k)) strain[k] -= correction[k];
    if (!(norm(strain) <= largest_strain_sought)) return false;
  }
  return false;
}

/// The strains of the step before where stress is controlled.
SymmetricTensor MaterialPoint::first_guess(const MixedIncrement& increment) const {
  SymmetricTensor strain = increment.change;
  for (int k = 0; k < size; ++k)
    if (is_stress(increment, k)) strain[k] = m_last_step[k];
  return strain;
}

/// Stress reached minus stress wanted, 0 where strain is controlled.
SymmetricTensor MaterialPoint::misfit(const MixedIncrement& increment, const SymmetricTensor& start,
                                      const SymmetricTensor& stress) const {
  SymmetricTensor error;
  for (int k = 0; k < size; ++k)
    if (is_stress(increment, k)) error[k] = stress[k] - start[k] - increment.change[k];
  return error;
}

MaterialPoint::Response MaterialPoint::respond(const SymmetricTensor& strain_increment) const {
  Response response{m_stress, m_state};
  m_material.update_stress(one_particle(strain_increment, response.stress, response.state));
  return response;
}

/// Derivatives of the stress-controlled components by finite differences; unity elsewhere.
MaterialPoint::Matrix MaterialPoint::tangent(const MixedIncrement& increment,
                                             const SymmetricTensor& strain) const {
  const double size_of_strain = norm(strain);
  const double difference = std::max(1e-3 * size_of_strain, 1e-10);
  const SymmetricTensor base = respond(strain).stress;
  Matrix matrix{};
  for (int k = 0; k < size; ++k) {
    const auto i = static_cast<std::size_t>(k);
    matrix[i][k] = 1.0;
    if (!is_stress(increment, k)) continue;
    SymmetricTensor column = derivative(strain, base, k, difference);
    if (size_of_strain == 0.0) {  // at a turn unloading, which is stiffer, comes first
      const SymmetricTensor other = derivative(strain, base, k, -difference);
      if (other[k] > column[k]) column = other;
    }
    for (int row = 0; row < size; ++row)
      if (is_stress(increment, row)) matrix[static_cast<std::size_t>(row)][k] = column[row];
    // On an edge of a yield surface only sums of strains count; this shares them evenly.
    matrix[i][k] += 1e-6 * norm(column);
  }
  return matrix;
}

/// Of the stress by one component of the strain.
SymmetricTensor MaterialPoint::derivative(SymmetricTensor strain, const SymmetricTensor& base,
                                          int component, double difference) const {
  strain[component] += difference;
  return (1.0 / difference) * (respond(strain).stress + (-1.0) * base);
}

namespace {

/// A standard test as one leg; axial is yy, out of plane zz.
PathLeg standard_leg(const ElementTestSettings& settings) {
  PathLeg leg;
  leg.increments = settings.increments;
  leg.origin = "the test";
  const auto hold_stress = [&leg](int k) {
    leg.control[static_cast<std::size_t>(k)] = Control::stress;
  };
  switch (settings.kind) {
    case ElementTestKind::triaxial_compression:
    case ElementTestKind::triaxial_extension:
      hold_stress(xx);
      hold_stress(zz);
      break;
    case ElementTestKind::plane_strain:
      hold_stress(xx);
      break;
    case ElementTestKind::simple_shear_constant_volume:
      leg.target[xy] = 0.5 * settings.strain_end;
      return leg;
    case ElementTestKind::oedometer:
    case ElementTestKind::path:
      break;
  }
  const bool extends = settings.kind == ElementTestKind::triaxial_extension;
  leg.target[yy] = extends ? settings.strain_end : -settings.strain_end;
  return leg;
}

/// Targets of the leg, those that hold taken from the point.
SymmetricTensor targets(const PathLeg& leg, const MaterialPoint& point) {
  SymmetricTensor target;
  for (int k = 0; k < size; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool stress = leg.control[i] == Control::stress;
    target[k] = leg.target[i].value_or(stress ? point.stress()[k] : point.strain()[k]);
  }
  return target;
}

/// The next of `remaining` equal parts of the way to the target.
MixedIncrement part_of_way(const PathLeg& leg, const SymmetricTensor& target,
                           const MaterialPoint& point, std::size_t remaining) {
  MixedIncrement increment{.control = leg.control, .change = target};
  for (int k = 0; k < size; ++k)
    increment.change[k] -= is_stress(increment, k) ? point.stress()[k] : point.strain()[k];
  increment.change *= 1.0 / static_cast<double>(remaining);
  return increment;
}

double lode_angle_deg(const SymmetricTensor& s, double q, double p) {
  if (!(q > 1e-9 * std::abs(p))) return 0.0;
  const double sin3theta = std::clamp(13.5 * determinant((1.0 / q) * s), -1.0, 1.0);
  return std::asin(sin3theta) / 3.0 * 180.0 / std::numbers::pi;
}

ElementTestRow observe(const MaterialPoint& point, ElementTestKind kind) {
  const SymmetricTensor s = deviator(point.stress());
  const double q = std::sqrt(1.5 * contract(s, s));
  const double p = -trace(point.stress()) / 3.0;
  const bool shears = kind == ElementTestKind::simple_shear_constant_volume;
  return {.axial_strain = shears ? 2.0 * point.strain()[xy] : 0.0 - point.strain()[yy],
          .q = q,
          .p = p,
          .volumetric_strain = 0.0 - trace(point.strain()),  // no negative zero
          .void_ratio = point.state("void_ratio").value_or(0.0),
          .lode_angle_deg = lode_angle_deg(s, q, p),
          .stress = point.stress(),
          .strain = point.strain()};
}

void follow(const PathLeg& leg, ElementTestKind kind, MaterialPoint& point,
            std::vector<ElementTestRow>& rows) {
  const SymmetricTensor target = targets(leg, point);
  point.turn();
  for (std::size_t k = 0; k < leg.increments; ++k) {
    try {
      point.apply(part_of_way(leg, target, point, leg.increments - k));
    } catch (const NumericalFailure& failure) {
      throw NumericalFailure(fmt::format("{}, increment {} of {}: {}", leg.origin, k + 1,
                                         leg.increments, failure.what()),
                             failure.details());
    }
    rows.push_back(observe(point, kind));
  }
}

void check(const ElementTestSettings& settings) {
  if (!(settings.confining_pressure >= 0.0))
    throw BadInput(
        fmt::format("-confining_pressure {}: must not be negative", settings.confining_pressure));
  if (settings.kind == ElementTestKind::path) {
    if (settings.path.empty()) throw BadInput("-test path: the path has no legs");
    return;
  }
  if (!(settings.strain_end > 0.0))
    throw BadInput(
        fmt::format("-strain_end {}: must be positive (a magnitude)", settings.strain_end));
  if (settings.increments == 0) throw BadInput("-increments 0: must be at least 1");
}

}  // namespace

std::vector<ElementTestRow> run_element_test(const Material& material,
                                             const ElementTestSettings& settings) {
  check(settings);
  MaterialPoint point(material, settings.confining_pressure);
  std::vector<ElementTestRow> rows{observe(point, settings.kind)};
  const std::vector<PathLeg> legs =
      settings.kind == ElementTestKind::path ? settings.path : std::vector{standard_leg(settings)};
  for (const PathLeg& leg : legs) follow(leg, settings.kind, point, rows);
  return rows;
}

}  // namespace mpm::material
