#pragma once

#include "SandFlow.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/material/LoadingSurface.hpp"

namespace mpm::material {

/// What a step needs to know of the old stress deviator s and the strain deviator e of four
/// particles. Every deviator on the way is a s + b e, and so these seven numbers do for any number
/// of components.
struct DeviatorPlane {
  simd::Pack s_s, s_e, e_e;                 ///< s : s and so on
  simd::Pack det_s, turn_s, turn_e, det_e;  ///< det s, cof(s) : e, cof(e) : s, det e
};

/// Four sands and their strain increments; compression positive but for the deviators.
struct SandPack {
  simd::Pack p_star, eps_q, specific_volume, gap;
  simd::Pack deps_v;
  DeviatorPlane plane;
};

/// The end of a step: the deviator is `of_stress` s + `of_strain` e. Where `done` is not set the
/// rest means nothing.
struct SandPackEnd {
  simd::Pack p_star, eps_q, specific_volume;
  simd::Pack of_stress, of_strain;
  simd::Mask done;
};

/// Four particles through one step, where one part will do: a plastic one, within the tolerance,
/// or an elastic one that ends inside the surface. It is the same step that SandIntegrator takes
/// then, to round-off; all else is left to it.
///
/// No lane looks at another one: a particle's bits are the same in any lane and company.
class SandPackIntegrator {
 public:
  SandPackIntegrator(const LoadingSurface& surface, const SandParameters& sand)
      : m_surface(surface), m_floor(sand.pressure_floor), m_tolerance(sand.tolerance) {}

  /// Not inlined, so that there is but one version of its arithmetic.
  [[gnu::noinline]] void advance(const SandPack& y, SandPackEnd& end) const;

 private:
  const LoadingSurface& m_surface;
  double m_floor;
  double m_tolerance;
};

}  // namespace mpm::material
