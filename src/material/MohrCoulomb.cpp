#include "mpm/material/MohrCoulomb.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mpm/core/Errors.hpp"
#include "mpm/core/Principal.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {
namespace {

double principal_stress_ratio(double angle_degrees) {
  const double sine = std::sin(angle_degrees * std::numbers::pi / 180.0);
  return (1.0 + sine) / (1.0 - sine);
}

const MohrCoulombParameters& validated(const MohrCoulombParameters& parameters) {
  const auto& [elastic, phi, psi, c] = parameters;
  if (!(phi >= 0.0 && phi < 90.0))
    throw BadInput(fmt::format(
        "-mohr_coulomb_friction_angle {}: must be at least 0 and below 90 degrees", phi));
  if (!(psi >= 0.0 && psi <= phi))
    throw BadInput(fmt::format(
        "-mohr_coulomb_dilation_angle {}: must lie between 0 and -mohr_coulomb_friction_angle {}",
        psi, phi));
  if (!(c >= 0.0))
    throw BadInput(fmt::format("-mohr_coulomb_cohesion {}: must not be negative", c));
  if (phi == 0.0 && c == 0.0)
    throw BadInput(
        "-mohr_coulomb_cohesion 0: must be positive where -mohr_coulomb_friction_angle is 0, or "
        "the material has no strength");
  return parameters;
}

/// sqrt(2/3) of the size of the deviator of a stress with these principal values.
double deviatoric_size(const MohrCoulomb::PrincipalStress& stress) {
  const auto& [a, b, c] = stress;
  return std::sqrt(2.0 / 9.0 * ((a - b) * (a - b) + (b - c) * (b - c) + (c - a) * (c - a)));
}

}  // namespace

MohrCoulomb::MohrCoulomb(const MohrCoulombParameters& parameters)
    : m_parameters(validated(parameters)),
      m_elastic(parameters.elastic, "mohr_coulomb"),
      m_N(principal_stress_ratio(parameters.friction_angle)),
      m_N_dilation(principal_stress_ratio(parameters.dilation_angle)),
      m_compressive_strength(2.0 * parameters.cohesion * std::sqrt(m_N)),
      m_apex(parameters.friction_angle > 0.0 ? m_compressive_strength / (m_N - 1.0)
                                             : std::numeric_limits<double>::infinity()) {}

std::span<const StateVariable> MohrCoulomb::state_variables() const {
  static const std::array<StateVariable, 1> variables{
      {{"plastic_strain", "accumulated plastic deviatoric strain, grows only", "1", 0.0}}};
  return variables;
}

void MohrCoulomb::update_stress(const Batch& batch) const {
  double* const plastic_strain = batch.state[0];
  for (std::size_t p = 0; p < batch.size; ++p) {
    SymmetricTensor stress =
        batch.stress.load(p) + m_elastic.stress_increment(batch.strain_increment.load(p));
    Principal trial = principal(stress);
    if (yield_function(trial.value) > 0.0) {
      PrincipalStress removed = trial.value;
      trial.value = return_to_surface(trial.value);
      stress = compose(trial);
      for (std::size_t k = 0; k < 3; ++k) removed[k] -= trial.value[k];
      plastic_strain[p] += deviatoric_size(removed) / (2.0 * m_elastic.shear_modulus());
    }
    batch.stress.store(p, stress);
  }
}

/// a D b with the gradients a of f and b of the potential on one plane.
double MohrCoulomb::stiffness_against_own_flow() const {
  return m_elastic.lambda() * (m_N - 1.0) * (m_N_dilation - 1.0) +
         2.0 * m_elastic.shear_modulus() * (m_N * m_N_dilation + 1.0);
}

/// A return whose principal stresses change their order belongs to the edge where they are equal.
/// Where both pairs change it, the trial lies behind the apex, and so does the return to either
/// edge.
MohrCoulomb::PrincipalStress MohrCoulomb::return_to_surface(const PrincipalStress& trial) const {
  const PrincipalStress plane = return_to_plane(trial);
  const bool leaves_compression = plane[0] < plane[1];
  const bool leaves_extension = plane[1] < plane[2];
  if (!leaves_compression && !leaves_extension) return plane;
  const PrincipalStress edge =
      return_to_edge(trial, leaves_compression ? Edge::compression : Edge::extension);
  if (edge[0] <= m_apex) return edge;
  return {m_apex, m_apex, m_apex};
}

MohrCoulomb::PrincipalStress MohrCoulomb::return_to_plane(const PrincipalStress& trial) const {
  const double multiplier = yield_function(trial) / stiffness_against_own_flow();
  const double isotropic = m_elastic.lambda() * (m_N_dilation - 1.0) * multiplier;
  const double G2 = 2.0 * m_elastic.shear_modulus();
  const double largest = trial[0] - isotropic - G2 * m_N_dilation * multiplier;
  return {largest, trial[1] - isotropic, m_N * largest - m_compressive_strength};
}

/// Two planes meet: in compression those of (sigma_1, sigma_3) and (sigma_2, sigma_3), in extension
/// those of (sigma_1, sigma_3) and (sigma_1, sigma_2). By symmetry only the sum of their
/// multipliers is needed.
MohrCoulomb::PrincipalStress MohrCoulomb::return_to_edge(const PrincipalStress& trial,
                                                         Edge edge) const {
  const bool compresses = edge == Edge::compression;
  const double G2 = 2.0 * m_elastic.shear_modulus();
  const double of_other = compresses ? yield_function({trial[1], 0.0, trial[2]})
                                     : yield_function({trial[0], 0.0, trial[1]});
  const double against_other = m_elastic.lambda() * (m_N - 1.0) * (m_N_dilation - 1.0) +
                               G2 * (compresses ? 1.0 : m_N * m_N_dilation);
  const double multipliers =
      (yield_function(trial) + of_other) / (stiffness_against_own_flow() + against_other);
  const double isotropic = m_elastic.lambda() * (m_N_dilation - 1.0) * multipliers;
  if (compresses) {
    const double largest =
        0.5 * (trial[0] + trial[1]) - isotropic - 0.5 * G2 * m_N_dilation * multipliers;
    return {largest, largest, m_N * largest - m_compressive_strength};
  }
  const double largest = trial[0] - isotropic - G2 * m_N_dilation * multipliers;
  const double smallest = m_N * largest - m_compressive_strength;
  return {largest, smallest, smallest};
}

void MohrCoulomb::wave_modulus(const Batch& batch, std::span<double> modulus) const {
  m_elastic.wave_modulus(batch, modulus);
}

void MohrCoulomb::initialise_from_stress(const Batch& batch) const {
  for (std::size_t p = 0; p < batch.size; ++p) {
    const PrincipalStress stress = principal(batch.stress.load(p)).value;
    const double size = std::abs(stress[0]) + std::abs(stress[2]) + m_compressive_strength;
    if (!(yield_function(stress) <= 1e-9 * m_N * size))
      throw BadInput(fmt::format(
          "-mohr_coulomb_friction_angle {} and -mohr_coulomb_cohesion {} do not carry the initial "
          "stress: its largest and smallest principal values are {:.6g} and {:.6g} Pa (tension "
          "positive), and with the first the second must be at least {:.6g} Pa; start from a more "
          "even stress or raise one of the two",
          m_parameters.friction_angle, m_parameters.cohesion, stress[0], stress[2],
          m_N * stress[0] - m_compressive_strength));
    batch.state[0][p] = 0.0;
  }
}

std::size_t MohrCoulomb::count_at_limits(const Batch& batch) const {
  if (!std::isfinite(m_apex)) return 0;
  const double reach = m_apex - 1e-9 * (m_apex + 1.0);  // 1 Pa, for an apex at 0
  std::size_t count = 0;
  for (std::size_t p = 0; p < batch.size; ++p)
    if (trace(batch.stress.load(p)) >= 3.0 * reach) ++count;
  return count;
}

void MohrCoulombFactory::declare(options::OptionSet& set) {
  const options::RealRange angle{.minimum = 0.0, .maximum = 90.0, .open_maximum = true};
  set.section("Mohr-Coulomb material");
  declare_linear_elastic(set, "mohr_coulomb", m_parameters.elastic);
  set.real("mohr_coulomb_friction_angle", m_parameters.friction_angle, angle,
           {"degrees", "Friction angle phi; 0 makes the material Tresca's.", "chosen"});
  set.real("mohr_coulomb_dilation_angle", m_parameters.dilation_angle, angle,
           {"degrees", "Dilation angle psi, not above the friction angle.", "chosen"});
  set.real("mohr_coulomb_cohesion", m_parameters.cohesion, options::not_negative(),
           {"Pa", "Cohesion c.", "chosen"});
}

std::unique_ptr<Material> MohrCoulombFactory::create() const {
  return std::make_unique<MohrCoulomb>(m_parameters);
}

}  // namespace mpm::material
