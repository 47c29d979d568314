#include "SandPack.hpp"

#include <array>

namespace mpm::material {

using simd::Mask;
using simd::Pack;
using simd::select;

namespace {

/// Distance from Euler, relative to the stress deviator, up to which the surface is taken to first
/// order from the Euler point; what is left out is of the square of this.
constexpr double first_order = 3e-6;

Pack clamp_sine(Pack x) {
  return simd::max(simd::min(x, simd::broadcast(1.0)), simd::broadcast(-1.0));
}

}  // namespace

/// q and Lode angle of a deviator, and how the strain increment changes them.
struct SandPackIntegrator::View {
  View() = default;
  explicit View(const Deviator& d) {
    const Pack q2 = 1.5 * d.square;
    const Pack inverse_q2 = 1.0 / q2;
    q = simd::sqrt(q2);
    inverse_q = q * inverse_q2;
    sin3theta = clamp_sine(13.5 * d.det * inverse_q2 * inverse_q);
    deps_q = d.along * inverse_q;
    turn = inverse_q * (27.0 * d.turn * inverse_q2 - 9.0 * sin3theta * deps_q);
    exact = d.exact;
  }

  Pack q, inverse_q, sin3theta;
  Pack deps_q;  ///< sqrt(2/3) n : e
  Pack turn;    ///< dsin3theta/G
  Mask exact;
};

/// The end of an Euler step, or of an elastic one in lanes that are not plastic.
struct SandPackIntegrator::Trial {
  State state(const SandPack& y, Pack sin3theta) const {
    return {p_star, specific_volume - 1.0, y.eps_q + growth, sin3theta};
  }

  Pack p_star, specific_volume;
  Pack growth;  ///< of eps_q
  Pack a, b;    ///< deviator a s + b e
  SurfaceChange<Pack> change;
  Pack dp, G2, shrink;  ///< the Euler step: ds = 2G e - shrink s
  Mask plastic, possible;
};

/// The end of a modified Euler step, with qhat to first order but at the trial's Lode angle.
struct SandPackIntegrator::Correction {
  Pack p_star, growth;
  Pack a, b;
  Pack qhat, T, sin3theta;
  Mask possible;
};

inline SandFlow<Pack> SandPackIntegrator::flow_at(const SandPack& y, const State& state,
                                                  const View& v, const Point& point) const {
  return sand_flow(m_surface, state, point, v.q, {y.deps_v, v.deps_q, Pack(point.G * v.turn)});
}

inline SandPackIntegrator::Trial SandPackIntegrator::predict(const SandPack& y, const View& v,
                                                             const Point& point) const {
  const Pack p0 = y.p_star;
  const Mask on_surface = v.q >= point.qhat - surface_tolerance * p0;
  SandFlow<Pack> flow{};
  if (simd::any(on_surface))
    flow = flow_at(y, {p0, y.specific_volume - 1.0, y.eps_q, v.sin3theta}, v, point);
  const auto elastic = m_surface.elasticity().follow_little(p0, point.G, point.stiffness, y.deps_v);

  Trial end;
  end.plastic = on_surface & flow.loading;
  end.dp = flow.p_star;
  end.G2 = 2.0 * point.G;
  end.shrink = 3.0 * point.G * flow.lambda * v.inverse_q;
  end.p_star = select(end.plastic, p0 + flow.p_star, elastic.p_star);
  end.a = select(end.plastic, 1.0 - end.shrink, simd::broadcast(1.0));
  end.b = select(end.plastic, end.G2, 2.0 * elastic.mean_shear_modulus);
  end.growth = select(end.plastic, flow.eps_q, Pack{});
  end.specific_volume = y.specific_volume * simd::small_exp(-y.deps_v);
  end.change = {(end.p_star - p0) / p0, end.specific_volume - y.specific_volume, end.growth};
  end.possible = can_go_on(y, v, point, end);
  return end;
}

/// Comparisons with NaN are false, so that it goes to SandIntegrator, too.
inline Mask SandPackIntegrator::can_go_on(const SandPack& y, const View& v, const Point& point,
                                          const Trial& trial) const {
  constexpr double limit = simd::small_limit;
  constexpr double shear = largest_elastic_part - 2.0 * limit;  // together with K deps_v
  const Pack p0 = y.p_star, volumetric = simd::abs(y.deps_v);
  const Mask few_parts = (6.0 * point.G * point.G * y.plane.e_e <= shear * shear * p0 * p0) &
                         (volumetric * point.stiffness <= limit);
  const Mask above_floor = (y.gap <= 1.0) & (p0 > m_lowest) & (trial.p_star > m_lowest);
  return above_floor & few_parts & (volumetric <= limit) & (v.q > vanishing_ratio * p0) &
         m_surface.is_nearby(trial.change, point.critical_slope);
}

inline SandPackIntegrator::Correction SandPackIntegrator::correct(const SandPack& y,
                                                                  const Trial& trial, const View& v,
                                                                  const Point& point) const {
  const Mask inside = v.q <= point.qhat + 0.5 * surface_tolerance * trial.p_star;
  Correction end{};
  end.possible = trial.possible & v.exact & (trial.plastic | inside);
  if (!simd::any(trial.plastic)) return end;

  const State state = trial.state(y, v.sin3theta);
  const SandFlow<Pack> flow = flow_at(y, state, v, point);
  const Pack shrink = 3.0 * point.G * flow.lambda * v.inverse_q;
  end.p_star = y.p_star + 0.5 * (trial.dp + flow.p_star);
  end.growth = 0.5 * (trial.growth + flow.eps_q);
  end.a = 1.0 - 0.5 * (trial.shrink + shrink * trial.a);
  end.b = 0.5 * (trial.G2 + (2.0 * point.G - shrink * trial.b));

  const SurfaceSlopesOf<Pack> slopes = m_surface.slopes(state, point);
  end.qhat =
      point.qhat + slopes.C * (end.p_star - trial.p_star) + slopes.F * (end.growth - trial.growth);
  end.T = slopes.T;
  end.sin3theta = v.sin3theta;
  return end;
}

/// Looks at the error of the modified Euler step and returns to the surface.
inline SandPackEnd SandPackIntegrator::finish(const SandPack& y, const Trial& trial,
                                              const Correction& corrected,
                                              const Factors& factors) const {
  const Mask plastic = trial.plastic;
  if (!simd::any(plastic))
    return {trial.p_star, y.eps_q, trial.specific_volume, trial.a, trial.b, corrected.possible};

  const Deviator deviator = y.plane.at(corrected.a, corrected.b);
  const View v(deviator);
  const Pack p = corrected.p_star, dp = p - trial.p_star;
  const Pack difference =
      y.plane.square_of(corrected.a - trial.a, corrected.b - trial.b) + 3.0 * dp * dp;
  const Pack size = deviator.square + 3.0 * p * p;
  const Mask accepted = (difference <= m_tolerance * m_tolerance * size) & deviator.exact &
                        (p > m_lowest) & (v.q > vanishing_ratio * p);

  Pack qhat = corrected.qhat + corrected.T * (v.sin3theta - corrected.sin3theta);
  const Mask far = plastic & (difference > first_order * first_order * deviator.square);
  if (simd::any(far)) qhat = select(far, qhat_at(y, trial, corrected, v.sin3theta, factors), qhat);
  const Pack scale = qhat * v.inverse_q;
  return {select(plastic, p, trial.p_star),
          y.eps_q + select(plastic, corrected.growth, Pack{}),
          trial.specific_volume,
          select(plastic, corrected.a * scale, trial.a),
          select(plastic, corrected.b * scale, trial.b),
          corrected.possible & (accepted | ~plastic)};
}

inline Pack SandPackIntegrator::qhat_at(const SandPack& y, const Trial& trial,
                                        const Correction& corrected, Pack sin3theta,
                                        const Factors& factors) const {
  const State state{corrected.p_star, trial.specific_volume - 1.0, y.eps_q + corrected.growth,
                    sin3theta};
  const SurfaceChange<Pack> change{(corrected.p_star - y.p_star) / y.p_star,
                                   trial.change.void_ratio, corrected.growth};
  return m_surface.at(state, m_surface.factors_nearby(state, factors, change)).qhat;
}

/// At the floor or gaping, all of them.
inline bool SandPackIntegrator::none_can(std::span<const SandPack> y) const {
  Mask some{};
  for (const SandPack& pack : y) some |= (pack.gap <= 1.0) & (pack.p_star > m_lowest);
  return !simd::any(some);
}

void SandPackIntegrator::advance(std::span<const SandPack> y, std::span<SandPackEnd> end) const {
  if (none_can(y)) {
    for (SandPackEnd& pack : end) pack = SandPackEnd{};
    return;
  }
  std::array<View, block> view;
  std::array<Factors, block> factors;
  std::array<Point, block> point;
  std::array<Trial, block> trial;
  std::array<Correction, block> corrected;
  const std::size_t count = y.size();
  const auto each = [count](const auto& stage) {
    for (std::size_t k = 0; k < count; ++k) stage(k);
  };
  const auto start = [&](std::size_t k) -> State {
    return {y[k].p_star, y[k].specific_volume - 1.0, y[k].eps_q, view[k].sin3theta};
  };
  each([&](std::size_t k) { view[k] = View(y[k].plane.start()); });
  each([&](std::size_t k) { factors[k] = m_surface.factors(start(k)); });
  each([&](std::size_t k) { point[k] = m_surface.at(start(k), factors[k]); });
  each([&](std::size_t k) { trial[k] = predict(y[k], view[k], point[k]); });
  each([&](std::size_t k) { view[k] = View(y[k].plane.at(trial[k].a, trial[k].b)); });
  each([&](std::size_t k) {
    const State state = trial[k].state(y[k], view[k].sin3theta);
    point[k] = m_surface.at(state, m_surface.factors_nearby(state, factors[k], trial[k].change));
  });
  each([&](std::size_t k) { corrected[k] = correct(y[k], trial[k], view[k], point[k]); });
  each([&](std::size_t k) { end[k] = finish(y[k], trial[k], corrected[k], factors[k]); });
}

}  // namespace mpm::material
