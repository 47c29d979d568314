#pragma once

#include "mpm/core/Tensor.hpp"
#include "mpm/material/LoadingSurface.hpp"
#include "mpm/material/SandGap.hpp"

namespace mpm::material {

/// The sand at one particle. `s` is the stress deviator, tension positive; all else is compression
/// positive.
struct SandPoint {
  double p_star;           ///< p + p_c, Pa
  SymmetricTensor s;       ///< Pa
  double eps_q;            ///< strain measure of Eq. 12
  double specific_volume;  ///< 1 + e of the skeleton
  double gap;              ///< J_gap
};

/// A strain increment: compression-positive volume strain and tension-positive deviator.
struct SandStrain {
  double volumetric;
  SymmetricTensor deviatoric;
};

/// Integrates the law over one strain increment.
class SandIntegrator {
 public:
  SandIntegrator(const LoadingSurface& surface, const SandGap& gap, const SandParameters& sand)
      : m_surface(surface), m_gap(gap), m_floor(sand.pressure_floor), m_tolerance(sand.tolerance) {}

  /// False where the increment cannot be integrated.
  bool advance(SandPoint& y, SandStrain d) const;

 private:
  /// The surface and the direction of the deviator at a state.
  struct View {
    double q;
    SymmetricTensor direction;  ///< r = s/q, so that 3/2 r:r = 1
    bool has_direction;         ///< s is large enough to define r; else r is that of the strain
    SurfaceState arguments;
    SurfacePoint point;
  };
  struct Rates {
    double p_star;
    SymmetricTensor s;
    double eps_q;
    bool loading;
  };
  struct Progress {
    double remaining = 1.0;  ///< part of the increment still to be applied
    double substep = 1.0;    ///< size to try next
  };

  struct Trial {
    SandPoint end;
    double error;
  };

  bool at_floor(const SandPoint& y) const { return y.p_star <= m_floor * (1.0 + 1e-12); }
  bool advance_skeleton(SandPoint& y, const SandStrain& d) const;
  void drop_to_floor(SandPoint& y) const;
  void close_gap(SandPoint& y, SandStrain& d) const;
  View view(const SandPoint& y, const SandStrain& d) const;
  bool is_on_surface(const View& v) const;
  double excess(const SandPoint& y, const SandStrain& d) const;
  Rates rates(const View& v, const SandStrain& d) const;
  double lode_rate(const View& v, const SandStrain& d, double deps_q) const;
  SandPoint elastic_path(const SandPoint& y, const SandStrain& d, double part) const;
  double elastic_part(const SandPoint& y, const SandStrain& d, double remaining) const;
  double crossing(const SandPoint& y, const SandStrain& d, double end) const;
  bool elastic_step(SandPoint& y, const SandStrain& d, Progress& progress) const;
  bool plastic_step(SandPoint& y, const SandStrain& d, const Rates& k1, Progress& progress) const;
  Trial modified_euler(const SandPoint& y, const SandStrain& d, const Rates& k1, double part) const;
  void stop_at_floor(SandPoint& y, const SandPoint& end, const SandStrain& d, double part,
                     Progress& progress) const;
  void return_to_surface(SandPoint& y, const SandStrain& d) const;

  const LoadingSurface& m_surface;
  const SandGap& m_gap;
  double m_floor;
  double m_tolerance;
};

}  // namespace mpm::material
