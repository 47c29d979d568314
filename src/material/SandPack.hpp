#pragma once

#include <span>

#include "DeviatorPlane.hpp"
#include "SandFlow.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/material/LoadingSurface.hpp"

namespace mpm::material {

/// Four sands and their strain increments; compression positive but for the deviators.
struct SandPack {
  simd::Pack p_star, eps_q, specific_volume, gap;
  simd::Pack deps_v;
  DeviatorPlane plane;
};

/// The end of a step: the deviator is a s + b e. Where `done` is not set the rest means nothing.
struct SandPackEnd {
  simd::Pack p_star, eps_q, specific_volume;
  simd::Pack a, b;
  simd::Mask done;
};

/// Takes four particles at a time through the steps that nearly all are: a plastic one that is
/// accurate enough in one part, or an elastic one that ends inside the surface. It is the step that
/// SandIntegrator takes then, with the same measure of error, to 1e-10 p*. Anything else, be it at
/// the floor, out of the surface or on no surface at all, is left to SandIntegrator.
///
/// No lane looks at another one: a particle's bits are the same in any lane and any company, which
/// change with the number of ranks and with sorting.
class SandPackIntegrator {
 public:
  SandPackIntegrator(const LoadingSurface& surface, const SandParameters& sand)
      : m_surface(surface),
        m_lowest(sand.pressure_floor * (1.0 + 1e-9)),
        m_tolerance(sand.tolerance) {}

  /// Packs that go through the stages of a step side by side. One alone would mostly wait for its
  /// own roots and quotients, each of which needs the one before.
  static constexpr std::size_t block = 4;

  /// At most `block` packs.
  void advance(std::span<const SandPack> y, std::span<SandPackEnd> end) const;

 private:
  struct View;
  struct Trial;
  struct Correction;
  using Factors = SurfaceFactors<simd::Pack>;
  using Point = SurfacePointOf<simd::Pack>;
  using State = SurfaceStateOf<simd::Pack>;

  bool none_can(std::span<const SandPack> y) const;
  SandFlow<simd::Pack> flow_at(const SandPack& y, const State& state, const View& v,
                               const Point& point) const;
  Trial predict(const SandPack& y, const View& v, const Point& point) const;
  simd::Mask can_go_on(const SandPack& y, const View& v, const Point& point,
                       const Trial& trial) const;
  Correction correct(const SandPack& y, const Trial& trial, const View& v,
                     const Point& point) const;
  SandPackEnd finish(const SandPack& y, const Trial& trial, const Correction& corrected,
                     const Factors& factors) const;
  simd::Pack qhat_at(const SandPack& y, const Trial& trial, const Correction& corrected,
                     simd::Pack sin3theta, const Factors& factors) const;

  const LoadingSurface& m_surface;
  double m_lowest;  ///< Pa, above the floor by round-off
  double m_tolerance;
};

}  // namespace mpm::material
