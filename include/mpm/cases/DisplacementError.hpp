#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "mpm/run/Observer.hpp"

namespace mpm::cases {

/// Root mean square over all particles of |u - exact(X)|, m, with X the undeformed position.
/// Collective.
template <int dim, class Exact>
double rms_displacement_error(const solver::Simulation<dim>& simulation, const Exact& exact) {
  const auto view = simulation.particles().view();
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) {
    Vector<dim> X;
    for (int d = 0; d < dim; ++d) X[d] = view.position[d][p] - view.displacement[d][p];
    const Vector<dim> u = exact(X);
    for (int d = 0; d < dim; ++d) {
      const double error = view.displacement[d][p] - u[d];
      sum += error * error;
    }
  }
  const auto count = static_cast<double>(simulation.particles().global_count());
  return std::sqrt(simulation.communicator().sum(sum) / count);
}

/// Follows that error over time as a share of an amplitude.
template <int dim>
class DisplacementError : public run::Observer<dim> {
 public:
  /// At an undeformed position and a time, m.
  using Exact = std::function<Vector<dim>(const Vector<dim>&, double)>;

  /// `amplitude` in m. An error above `failure_share` of it counts as failure.
  DisplacementError(Exact exact, double amplitude,
                    double failure_share = std::numeric_limits<double>::max())
      : m_exact(std::move(exact)), m_amplitude(amplitude), m_failure_share(failure_share) {}

  void after_step(const run::Moment<dim>& now) override {
    const double time = now.clock.time;
    last = rms_displacement_error<dim>(now.simulation,
                                       [&](const Vector<dim>& X) { return m_exact(X, time); }) /
           m_amplitude;
    largest = std::max(largest, last);
    if (failed_at < 0.0 && last > m_failure_share) failed_at = time;
  }

  void persist(Archive& archive) override {
    archive("last", last);
    archive("largest", largest);
    archive("failed_at", failed_at);
  }

  double last = 0.0, largest = 0.0;  ///< share of the amplitude
  double failed_at = -1.0;           ///< s; negative if it has not failed

 private:
  Exact m_exact;
  double m_amplitude, m_failure_share;
};

}  // namespace mpm::cases
