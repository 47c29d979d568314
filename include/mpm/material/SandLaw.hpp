#pragma once

#include "mpm/material/LoadingSurface.hpp"
#include "mpm/material/Material.hpp"
#include "mpm/material/SandGap.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// Invariants of the sand law and its state, compression positive.
struct SandInvariants {
  double p_star;     ///< p + p_c, Pa
  double q;          ///< Pa
  double sin3theta;  ///< -1 in triaxial compression; 0 where q vanishes
};

/// J2-deformation sand law with state-dependent dilatancy (Yang, Xu & Li 2019; Eqs. 12-26).
/// q = qhat(p, e, eps_q, theta) is a loading surface: on it the step is plastic while the loading
/// index is positive, inside it elastic. Integrated by modified-Euler substeps with error control
/// and a return to the surface (Sloan, Abbo & Sheng 2001).
class SandLaw : public Material {
 public:
  /// Throws BadInput where validate() does.
  explicit SandLaw(const SandParameters& sand);

  /// Indices into Batch::state.
  enum State : std::size_t { void_ratio, eps_q, gap_volume_ratio };

  std::string_view name() const override { return "sand"; }
  std::span<const StateVariable> state_variables() const override { return m_state_variables; }
  double initial_density() const override;
  void update_stress(const Batch& batch) const override;
  void wave_modulus(const Batch& batch, std::span<double> modulus) const override;

  /// Puts every particle on the surface: eps_q is the smallest root of qhat(eps_q) = q. Throws
  /// BadInput with the stress ratio and the largest admissible one where there is no root.
  void initialise_from_stress(const Batch& batch) const override;

  /// Particles at the pressure floor, with a gap or at the cap of the state parameter.
  std::size_t count_at_limits(const Batch& batch) const override;

  const LoadingSurface& surface() const { return m_surface; }
  const SandGap& gap() const { return m_gap; }
  SandInvariants invariants(const SymmetricTensor& stress) const;

  /// Smallest eps_q with qhat = q; `y.eps_q` is ignored. Throws BadInput if q is too large.
  double strain_on_surface(SurfaceState y, double q) const;

 private:
  void update_alone(const Batch& batch, std::size_t i) const;

  SandParameters m_sand;
  LoadingSurface m_surface;
  SandGap m_gap;
  double m_cohesion_shift;
  std::vector<StateVariable> m_state_variables;
};

}  // namespace mpm::material
