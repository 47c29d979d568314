#pragma once

#include <cstddef>
#include <random>
#include <span>
#include <vector>

namespace mpm::analysis {

/// Scatter of a resistance curve, as a model that can be drawn from: N_d is a smooth curve plus
/// its local mean times (r + teeth).
/// - The smooth curve is a given shape times a cubic spline whose knots are 0.05 to 0.15 in u/D
///   apart, by Akaike's criterion.
/// - r is first-order autoregressive from step to step, r_k = phi r_(k-1) + e_k. Each draw takes
///   its own phi, by the restricted likelihood (Harville 1977, J. Am. Stat. Assoc. 72, 320-338)
///   with a flat prior on 0 to 0.9, and its own variance of e, by the chi-squared distribution: one
///   curve tells neither exactly. A phi of 0.9 reaches over 0.095 in u/D; what is longer is taken
///   for the curve itself.
/// - Teeth are three harmonics of a known period, of one relative height all along the curve, which
///   has to be four periods long.
/// Nothing is judged below a quarter of the largest N_d, where curves bend most sharply.
class CurveScatter {
 public:
  struct Memory {
    double phi = 0.0;
    double likelihood = 0.0;  ///< logarithm, up to a constant
    double squares = 0.0;     ///< sum of e^2
  };

  /// `shape` fits N_d roughly; both are means over steps of `step` in u/D, and the largest N_d is
  /// positive. `tooth_period` in u/D, 0 where no teeth are expected.
  CurveScatter(std::span<const double> N_d, std::span<const double> shape, double step,
               double tooth_period);

  /// False for a curve that is too short.
  bool can_be_judged() const { return !m_memories.empty(); }

  /// N_d without teeth, with the rest of its scatter; one entry per step.
  const std::vector<double>& resistance() const { return m_resistance; }

  /// resistance() with as much scatter again. Deterministic for a given engine.
  std::vector<double> with_more(std::mt19937_64& engine) const;

 private:
  std::vector<double> relative() const;
  void add(std::span<const double> heights, std::vector<double>& N_d) const;
  void remove_teeth(double period);
  void set_memories(double step);
  const Memory& drawn_memory(std::mt19937_64& engine) const;

  std::vector<double> m_resistance;
  std::vector<double> m_scale;               ///< local mean, which scatter is relative to
  std::size_t m_first = 0;                   ///< step from which scatter is judged
  std::vector<double> m_carrier;             ///< shape over local mean, from that step on
  std::vector<std::vector<double>> m_teeth;  ///< sine and cosine of each harmonic
  std::vector<double> m_tooth_deviations;    ///< of the height of each
  std::vector<Memory> m_memories;
  double m_freedom = 0.0;  ///< steps less coefficients
};

}  // namespace mpm::analysis
