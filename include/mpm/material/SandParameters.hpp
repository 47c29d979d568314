#pragma once

#include <string>

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

/// Readings of what D of Eq. 17 compares the stress ratio with.
enum class Dilatancy {
  printed,  ///< D = d0 [exp(m psi) - eta/(Mc g)]
  lode      ///< g D in its place, so that the Lode angle leaves the limit of strength alone
};

/// Readings of the bulk modulus K, Eq. 24.
enum class BulkModulus {
  log,     ///< (1 + e0) p*/kappa
  power,   ///< (1 + e0) p*/(kappa bulk_xi) (p_a/p*)^bulk_xi
  poisson  ///< 2G(1 + nu)/(3(1 - 2nu))
};

/// What makes one sand another one: constants of the J2-deformation law with state-dependent
/// dilatancy and the readings of its equations. Those of Stockton Beach sand, Table 1 of the paper,
/// unless stated. Names as in docs/model.md; the options have the same with -sand_.
struct SandConstants {
  double G0 = 250.0;           ///< elastic shear modulus, Eq. 15
  double kappa = 0.012;        ///< elastic swelling, Eq. 24
  double Mc = 1.24;            ///< critical stress ratio in triaxial compression
  double c = 0.75;             ///< ratio of critical stress ratios, extension to compression
  double e_Gamma = 0.925;      ///< critical void ratio at 1 kPa (with xi: at zero pressure)
  double lambda_c = 0.037;     ///< slope of the critical line
  std::optional<double> xi;    ///< exponent of the critical line's power form, Eq. 19
  double d0 = 0.45;            ///< dilatancy, Eq. 17
  double m = 4.1;              ///< dilatancy, Eq. 17
  double eps_r = 0.06;         ///< reference strain of softening, Eq. 12
  double Gs = 2.65;            ///< specific gravity of the grains
  double e_max = 0.778;        ///< loosest packing
  double e_min = 0.497;        ///< densest packing
  double d50 = 0.4e-3;         ///< m, mean diameter of the grains
  double bulk_xi = 0.5;        ///< exponent of BulkModulus::power
  double poisson_ratio = 0.2;  ///< of BulkModulus::poisson
  Softening softening = Softening::normalized;
  Dilatancy dilatancy = Dilatancy::printed;
  BulkModulus bulk = BulkModulus::log;
  /// J_gap - 1 over which the tension of a gap fades; without it, gaps keep that of the floor.
  std::optional<double> gap_opening;
};

/// A sand as it lies in the ground, and how the law is computed.
struct SandParameters : SandConstants {
  double void_ratio = 0.524;     ///< e0, initial void ratio
  double cohesion = 1000.0;      ///< Pa
  double pressure_floor = 10.0;  ///< Pa, lowest p*
  double psi_cap = 0.15;         ///< largest state parameter in the dilatancy
  double tolerance = 1e-4;       ///< relative error of stress in one substep
  CohesionShift cohesion_shift = CohesionShift::plain;
};

/// p_a of Eqs. 15, 19 and 24, Pa.
inline constexpr double atmospheric_pressure = 101e3;

/// phi_c in radians: sin(phi_c) = 3 Mc/(6 + Mc).
double critical_friction_angle(const SandConstants& sand);

/// p_c in Pa, the shift of the mean stress by cohesion.
double cohesion_shift(const SandParameters& sand);

/// (e_max - e0)/(e_max - e_min), 1 when densest.
double relative_density(const SandParameters& sand);

/// e0 of a relative density.
double void_ratio_at(double relative_density, const SandConstants& sand);

/// Throws BadInput on combinations that make no sense together, which names them with the prefix
/// of their options.
void validate(const SandParameters& sand, const std::string& prefix = {});

}  // namespace mpm::material
