#pragma once

#include <cstddef>
#include <random>
#include <span>
#include <vector>

namespace mpm::analysis {

struct ScatterOptions {
  /// Distance in u/D over which the curve itself may bend; what is shorter is scatter.
  double bend = 0.15;
  /// Period in u/D of saw-teeth from grid lines, a cell over D; 0 where none are expected.
  double tooth_period = 0.0;
};

/// What is left of a resistance curve when a smooth curve is taken off, as a model that can be
/// drawn from: N_d = smooth (1 + r + teeth). r is first-order autoregressive from step to step, r_k
/// = phi r_(k-1) + e_k; teeth are three harmonics of the tooth period. The smooth curve is a given
/// shape times a cubic spline. How well phi and the variance of e are known from one curve is part
/// of the model: each draw takes its own, phi by its restricted likelihood (Harville 1977, J. Am.
/// Stat. Assoc. 72, 320-338; flat prior on 0 to 0.8, a reach of 0.045 in u/D), the variance by its
/// chi-squared distribution. Deterministic for a given engine.
class CurveScatter {
 public:
  /// `shape` is positive or zero and fits N_d roughly; both are means over steps of `step` in u/D.
  CurveScatter(std::span<const double> N_d, std::span<const double> shape, double step,
               const ScatterOptions& options = {});

  /// The curve without scatter, dimensionless like N_d.
  const std::vector<double>& smooth() const { return m_smooth; }

  /// The smooth curve with scatter of its own.
  std::vector<double> draw(std::mt19937_64& engine) const;

 private:
  struct Memory {
    double phi = 0.0;
    double likelihood = 0.0;  ///< logarithm, up to a constant
    double squares = 0.0;     ///< sum of e^2
    std::vector<double> coefficients;
    std::vector<double> variances;  ///< of the coefficients
  };

  Memory fit(const std::vector<std::vector<double>>& columns, const std::vector<double>& relative,
             double phi) const;
  void set_smooth(const Memory& best, const std::vector<std::vector<double>>& columns);
  void set_teeth(const Memory& best, std::size_t first_tooth);
  double teeth(double u_over_D) const;
  const Memory& drawn_memory(std::mt19937_64& engine) const;

  double m_step = 0.0;
  double m_tooth_period = 0.0;
  double m_freedom = 0.0;        ///< steps less coefficients
  std::size_t m_first = 0;       ///< step from which the scatter is judged
  std::vector<double> m_smooth;  ///< one entry per step
  std::vector<double> m_scale;   ///< what the scatter is relative to
  std::vector<double> m_teeth;   ///< coefficients of sine and cosine, harmonic by harmonic
  std::vector<Memory> m_memories;
};

}  // namespace mpm::analysis
