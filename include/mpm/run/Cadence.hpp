#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "mpm/run/Observer.hpp"

namespace mpm::run {

/// When a sample is due: every so many steps since the main stage began, or whenever a quantity
/// that grows has passed the next mark.
template <int dim>
class Cadence {
 public:
  using Measure = std::function<double(const Moment<dim>&)>;

  explicit Cadence(long long steps) : m_steps(steps) {}
  /// `first` is the first mark; the multiples of `spacing` beyond it follow.
  Cadence(double spacing, Measure measure, double first = 0.0)
      : m_spacing(spacing), m_next(first > 0.0 ? first : spacing), m_measure(std::move(measure)) {}
  /// Marks in ascending order.
  Cadence(std::vector<double> marks, Measure measure)
      : m_next(marks.front()), m_marks(std::move(marks)), m_measure(std::move(measure)) {}

  /// Marks so much apart from where the last sample was.
  static Cadence apart(double spacing, Measure measure) {
    Cadence cadence(spacing, std::move(measure));
    cadence.m_counts_from_last = true;
    return cadence;
  }

  /// Every so many steps where that is asked for (not 0), else this.
  Cadence or_every(long long steps) const { return steps > 0 ? Cadence(steps) : *this; }

  /// Goes on to the next mark where it is due.
  bool is_due(const Moment<dim>& moment) {
    if (m_steps > 0) return moment.clock.counted_steps % m_steps == 0;
    const double now = m_measure(moment);
    if (now < m_next) return false;
    m_next = mark_after(now);
    return true;
  }

  void persist(Archive& archive) { archive("next", m_next); }

 private:
  static constexpr double round_off = 1e-6;  // of a spacing

  double mark_after(double now) const {
    if (m_counts_from_last) return now + m_spacing;
    if (m_marks.empty()) return m_spacing * (std::floor(now / m_spacing + round_off) + 1.0);
    for (const double mark : m_marks)
      if (mark > now) return mark;
    return std::numeric_limits<double>::max();
  }

  long long m_steps = 0;
  double m_spacing = 0.0;
  double m_next = 0.0;
  bool m_counts_from_last = false;
  std::vector<double> m_marks;
  Measure m_measure;
};

}  // namespace mpm::run
