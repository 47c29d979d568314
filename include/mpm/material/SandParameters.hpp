#pragma once

#include <optional>

namespace mpm::material {

/// Readings of the softening term of Eq. 12, x = eps_q/eps_r. The printed exp(+x) is a misprint.
enum class Softening {
  normalized,     ///< f = x exp(1 - x), D holds q
  plain,          ///< f = x exp(-x), D holds q
  explicit_ratio  ///< f = x exp(1 - x), D holds the hyperbolic part h instead of q
};

/// What the cohesion c adds to the mean stress: p_c = c, or p_c = c cot(phi_c).
enum class CohesionShift { plain, cot_phi };

/// Constants of the J2-deformation sand law with state-dependent dilatancy. Stockton Beach sand,
/// Table 1, unless stated. Names as in docs/model.md; the options have the same with -sand_.
struct SandParameters {
  double void_ratio = 0.524;     ///< e0, initial void ratio
  double G0 = 250.0;             ///< elastic shear modulus, Eq. 15
  double kappa = 0.012;          ///< elastic swelling, Eq. 24
  double Mc = 1.24;              ///< critical stress ratio in triaxial compression
  double c = 0.75;               ///< ratio of critical stress ratios, extension to compression
  double e_Gamma = 0.925;        ///< critical void ratio at 1 kPa (with xi: at zero pressure)
  double lambda_c = 0.037;       ///< slope of the critical line
  double d0 = 0.45;              ///< dilatancy, Eq. 17
  double m = 4.1;                ///< dilatancy, Eq. 17
  double eps_r = 0.06;           ///< reference strain of softening, Eq. 12
  double Gs = 2.65;              ///< specific gravity of the grains
  double cohesion = 1000.0;      ///< Pa
  double pressure_floor = 10.0;  ///< Pa, lowest p*
  double psi_cap = 0.15;         ///< largest state parameter in the dilatancy
  double e_max = 0.778;          ///< loosest packing
  double e_min = 0.497;          ///< densest packing
  double tolerance = 1e-4;       ///< relative error of stress in one substep
  std::optional<double> xi;      ///< exponent of the power form, Eqs. 19 and 24
  Softening softening = Softening::normalized;
  CohesionShift cohesion_shift = CohesionShift::plain;
};

/// p_a of Eqs. 15, 19 and 24, Pa.
inline constexpr double atmospheric_pressure = 101e3;

/// phi_c in radians: sin(phi_c) = 3 Mc/(6 + Mc).
double critical_friction_angle(const SandParameters& sand);

/// p_c in Pa, the shift of the mean stress by cohesion.
double cohesion_shift(const SandParameters& sand);

/// (e_max - e0)/(e_max - e_min), 1 when densest.
double relative_density(const SandParameters& sand);

/// Throws BadInput on combinations that make no sense together.
void validate(const SandParameters& sand);

}  // namespace mpm::material
