#include "SandPack.hpp"

namespace mpm::material {
namespace {

using simd::Mask;
using simd::Pack;
using simd::select;

/// Part of the deviators that must be left of a s + b e, squared: below it the seven numbers of
/// the plane cancel.
constexpr double least_left = 1e-2;

/// A deviator in the plane.
struct Deviator {
  Pack q2;     ///< q^2
  Pack along;  ///< deviator : e
  Pack det;    ///< determinant
  Pack turn;   ///< derivative of the determinant along e
  Mask exact;
};

inline Deviator start_of(const DeviatorPlane& d) {
  return {1.5 * d.s_s, d.s_e, d.det_s, d.turn_s, d.s_s > 0.0};
}

inline Deviator combine(const DeviatorPlane& d, Pack a, Pack b) {
  const Pack aa = a * a, ab = a * b, bb = b * b;
  const Pack s_s = aa * d.s_s, e_e = bb * d.e_e;
  const Pack square = s_s + 2.0 * ab * d.s_e + e_e;
  return {1.5 * square, a * d.s_e + b * d.e_e,
          aa * (a * d.det_s + b * d.turn_s) + bb * (a * d.turn_e + b * d.det_e),
          aa * d.turn_s + 2.0 * ab * d.turn_e + 3.0 * bb * d.det_e,
          square > least_left * (s_s + e_e)};
}

/// q and Lode angle of a deviator, and how the strain increment changes them.
struct View {
  Pack q, inverse_q, sin3theta;
  Pack deps_q;  ///< sqrt(2/3) n : e
  Pack turn;    ///< dsin3theta/G
};

inline View view(const Deviator& d) {
  View v;
  v.q = simd::sqrt(d.q2);
  v.inverse_q = 1.0 / v.q;
  const Pack inverse_q2 = v.inverse_q * v.inverse_q;
  v.sin3theta = 13.5 * d.det * (inverse_q2 * v.inverse_q);
  v.sin3theta = simd::max(simd::min(v.sin3theta, simd::broadcast(1.0)), simd::broadcast(-1.0));
  v.deps_q = d.along * v.inverse_q;
  v.turn = v.inverse_q * (27.0 * d.turn * inverse_q2 - 9.0 * v.sin3theta * v.deps_q);
  return v;
}

}  // namespace

void SandPackIntegrator::advance(const SandPack& y, SandPackEnd& end) const {
  const SandElasticity& elasticity = m_surface.elasticity();
  const DeviatorPlane& plane = y.plane;
  const Pack p0 = y.p_star;
  const Pack lowest = simd::broadcast(m_floor * (1.0 + 1e-9));
  const auto flow_at = [&](const SurfaceStateOf<Pack>& state, const SurfacePointOf<Pack>& point,
                           const View& v) {
    return sand_flow(m_surface, state, point, v.q, {y.deps_v, v.deps_q, Pack(point.G * v.turn)});
  };

  // The surface at the start. A lane on it that loads takes an Euler step, others an elastic one.
  const View v0 = view(start_of(plane));
  const SurfaceStateOf<Pack> state0{p0, y.specific_volume - 1.0, y.eps_q, v0.sin3theta};
  const SurfaceFactors<Pack> factors0 = m_surface.factors(state0);
  const SurfacePointOf<Pack> point0 = m_surface.at(state0, factors0);
  const SandFlow<Pack> k1 = flow_at(state0, point0, v0);
  const Mask plastic = (v0.q >= point0.qhat - surface_tolerance * p0) & k1.loading;
  const auto elastic = elasticity.follow_little(p0, y.deps_v);
  const Pack G2_1 = 2.0 * point0.G, shrink1 = 3.0 * point0.G * k1.lambda * v0.inverse_q;

  // There, the surface again.
  const Pack p1 = select(plastic, p0 + k1.p_star, elastic.p_star);
  const Pack a1 = select(plastic, 1.0 - shrink1, simd::broadcast(1.0));
  const Pack b1 = select(plastic, G2_1, 2.0 * elastic.mean_shear_modulus);
  const Pack growth1 = select(plastic, k1.eps_q, Pack{});
  const Pack specific_volume = y.specific_volume * simd::small_exp(-y.deps_v);
  const Deviator deviator1 = combine(plane, a1, b1);
  const View v1 = view(deviator1);
  const SurfaceStateOf<Pack> state1{p1, specific_volume - 1.0, y.eps_q + growth1, v1.sin3theta};
  const Pack inverse_p0 = 1.0 / p0;
  const SurfaceChange<Pack> change1{(p1 - p0) * inverse_p0, specific_volume - y.specific_volume,
                                    growth1};
  const SurfacePointOf<Pack> point1 =
      m_surface.at(state1, m_surface.factors_nearby(state1, factors0, change1));

  constexpr double limit = simd::small_limit;
  constexpr double elastic_q = largest_elastic_part - 2.0 * limit;
  Mask done = (y.gap <= 1.0) & (p0 > lowest) & (p1 > lowest) & (v0.q > vanishing_ratio * p0) &
              (simd::abs(y.deps_v) <= limit) & m_surface.is_nearby(change1) & deviator1.exact &
              (6.0 * point0.G * point0.G * plane.e_e <= elastic_q * elastic_q * p0 * p0) &
              (simd::abs(y.deps_v) * elasticity.bulk_modulus(p0) <= limit * p0);
  const Mask inside = v1.q <= point1.qhat + 0.5 * surface_tolerance * p1;

  // Modified Euler and its distance from Euler.
  const SandFlow<Pack> k2 = flow_at(state1, point1, v1);
  const Pack G2_2 = 2.0 * point1.G, shrink2 = 3.0 * point1.G * k2.lambda * v1.inverse_q;
  const Pack p2 = p0 + 0.5 * (k1.p_star + k2.p_star);
  const Pack growth2 = 0.5 * (k1.eps_q + k2.eps_q);
  const Pack a2 = 1.0 - 0.5 * (shrink1 + shrink2 * a1);
  const Pack b2 = 0.5 * (G2_1 + (G2_2 - shrink2 * b1));
  const Deviator deviator2 = combine(plane, a2, b2);
  const Pack da = a2 - a1, db = b2 - b1, dp = p2 - p1;
  const Pack difference =
      da * (da * plane.s_s + 2.0 * db * plane.s_e) + db * db * plane.e_e + 3.0 * dp * dp;
  const Pack size = (2.0 / 3.0) * deviator2.q2 + 3.0 * p2 * p2;
  const Mask accepted = difference <= m_tolerance * m_tolerance * size;

  // Return to the surface.
  const View v2 = view(deviator2);
  const SurfaceStateOf<Pack> state2{p2, specific_volume - 1.0, y.eps_q + growth2, v2.sin3theta};
  const SurfaceChange<Pack> change2{(p2 - p0) * inverse_p0, change1.void_ratio, growth2};
  const SurfacePointOf<Pack> point2 =
      m_surface.at(state2, m_surface.factors_nearby(state2, factors0, change2));
  const Pack scale = point2.qhat * v2.inverse_q;

  const Mask plastic_done = accepted & deviator2.exact & (p2 > lowest) &
                            (v2.q > vanishing_ratio * p2) & m_surface.is_nearby(change2);
  end.done = done & ((plastic & plastic_done) | (~plastic & inside));
  end.p_star = select(plastic, p2, p1);
  end.eps_q = y.eps_q + select(plastic, growth2, Pack{});
  end.specific_volume = specific_volume;
  end.of_stress = select(plastic, a2 * scale, a1);
  end.of_strain = select(plastic, b2 * scale, b1);
}

}  // namespace mpm::material
