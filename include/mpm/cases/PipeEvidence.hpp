#pragma once

#include <string>
#include <vector>

#include "mpm/cases/PipeOptions.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {

/// What the pipe scene measures against its own answer: columns of its history, and the checks that
/// they are held against. All shares are of 1.
class PipeEvidence {
 public:
  explicit PipeEvidence(const PipeOptions& pipe) : m_pipe(pipe) {}

  /// In the order of row().
  static std::vector<std::string> columns();
  /// Particles at the law's limits and in the pipe; strain at the side wall, pressure at the
  /// bottom and residual of energy. `reaction` is that of the whole pipe, N/m. Collective.
  std::vector<double> row(const run::Moment<2>& now, const contact::RigidBody<2>& body,
                          double reaction) const;

 private:
  double strain_at_side(const particles::ParticleView<2>& view) const;
  double rise_at_bottom(const particles::ParticleView<2>& view) const;
  double strip() const;

  const PipeOptions& m_pipe;
};

/// The limits of what PipeEvidence and the reactions say, by check.
std::vector<run::Check> pipe_checks();

/// Where the columns are that evidence is taken from.
struct PipeColumns {
  std::size_t u_over_D, N_d, N_d_contour, inertia, first_of_evidence;
};

/// Holds the rows of a history against the checks: up to the answer at `u_df_over_D`, all of them
/// where that is no number, and to the end. The summary knows the particles.
void hold_evidence(const PipeOptions& pipe, const run::History<2>& history,
                   const PipeColumns& columns, double u_df_over_D, io::Summary& summary);

}  // namespace mpm::cases
