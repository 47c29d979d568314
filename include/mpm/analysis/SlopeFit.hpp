#pragma once

#include <span>
#include <string>
#include <vector>

namespace mpm::analysis {

/// The resistance curve on equal steps of u/D and its slope, one entry per step, dimensionless.
struct SlopeCurve {
  std::vector<double> u_over_D;  ///< middle of the step
  std::vector<double> N_d;       ///< mean over the step
  std::vector<double> slope;     ///< dN_d/d(u/D); NaN in the two first and the two last steps
};

/// Averages the curve on steps of `step` in u/D and differentiates it by a quadratic through five
/// steps (least squares). Row k of the input is the mean N_d since row k - 1 (row 0: since u = 0),
/// as history.csv has it. A last step that is covered by less than half is left out.
/// Throws BadInput for unequal lengths, a value that is not finite, or u/D that falls.
SlopeCurve slope_curve(std::span<const double> u_over_D, std::span<const double> N_d,
                       double step = 0.01);

/// Slopes of means over equal steps; NaN in the two first and the two last.
std::vector<double> slopes_of_steps(std::span<const double> N_d, double step);

/// A descending and a stable segment through the slope curve from its largest slope on. They meet
/// at the break. Where the slope stays near its largest for a while, the descent begins at the end
/// of that plateau.
struct SlopeFit {
  double start = 0.0;        ///< u/D of the first step fitted
  double plateau_end = 0.0;  ///< u/D where the descent begins; `start` without a plateau
  double break_point = 0.0;  ///< u/D
  double largest = 0.0;      ///< slope up to the end of the plateau
  double stable = 0.0;       ///< slope from the break on; not negative

  /// Fitted slope at u/D (start and beyond).
  double value(double u_over_D) const;
};

struct SlopeReading {
  bool found = false;
  SlopeFit fit;        ///< without meaning unless found
  std::string reason;  ///< why not, for the user
};

/// Least squares of the slopes from the first one that is at least 70 % of the largest, up to u/D =
/// `window`; both ends of the descent are free. The stable segment is level: with a gradient of
/// its own it would follow whatever comes late, softening or hardening, and take the break with
/// it. It is not negative: at a peak the resistance has stopped growing, and how it softens says
/// nothing about where. The descent takes five steps at least, over which the five-point slope
/// smears any corner, the stable segment ten.
SlopeReading read_slope(const SlopeCurve& curve, double window);

}  // namespace mpm::analysis
