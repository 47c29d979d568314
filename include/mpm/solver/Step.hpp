#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "mpm/basis/BSpline.hpp"
#include "mpm/grid/Constraint.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/BoundaryParticles.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/solver/Ledger.hpp"
#include "mpm/solver/StepTimes.hpp"
#include "mpm/transfer/PointDeposit.hpp"
#include "mpm/transfer/Transfer.hpp"

namespace mpm::solver {

/// How grid motion reaches the particles.
enum class Transfer {
  flip,  ///< by its change
  pic,   ///< by itself, which damps all that a node's surroundings do not share
  apic   ///< by itself, particles carrying the gradient of the velocity as well
};

/// What a step needs besides grid and particles.
template <int dim>
struct StepOptions {
  transfer::BodyForce<dim> body_force;
  double damping = 0.0;  ///< local damping: f -= damping |f| sign(v) per component
  Transfer transfer = Transfer::flip;
  /// Time tau in which particle velocities turn into the grid's, s: FLIP keeps exp(-dt/tau) of
  /// them per step; infinite is pure FLIP.
  double flip_time = std::numeric_limits<double>::infinity();

  /// Share s of the mean volume change of the surroundings in that of a particle, against scatter
  /// of pressures: theta <- s mean + (1 - s) theta. With s = 1 no pressure holds what alternates
  /// from cell to cell, and sand that dilates splits into stripes. Not under local damping: forces
  /// of a cell's size hardly feel averaged strains, and come to rest late and elsewhere.
  double averaged_volume_share = 0.0;

  bool averages() const { return averaged_volume_share > 0.0 && damping == 0.0; }
  double flip_share(double dt) const {
    return transfer == Transfer::flip ? std::exp(-dt / flip_time) : 0.0;
  }
};

/// What a rank found out in a step; ranks have to agree on it before they act.
struct StepReport {
  bool must_migrate = false;
  int broken_particle = -1;  ///< left the grid or has no finite stress; -1 if none
};

/// How soon a wave crosses a cell, over the particles of a rank.
struct Transit {
  double smallest = std::numeric_limits<double>::max();  ///< h_p / (c_p + |v_p|), s
  int of_particle = -1;
  int runaway = -1;  ///< a particle that is far faster than its own waves; -1 if none
};

/// One explicit step of the material point method, whatever its scheme and basis.
template <int dim>
class Step {
 public:
  virtual ~Step() = default;

  /// Advances grid and particles by times.dt. Collective.
  virtual StepReport advance(const StepTimes& times, const StepOptions<dim>& options) = 0;

  virtual Transit transit() const = 0;

  /// Sum over this rank's nodes of |f| after walls and constraints, without damping, in the last
  /// step, N.
  virtual double unbalanced_force() const = 0;

  virtual const transfer::PointDeposit<dim>& point_deposit() const = 0;

  /// Nodal mass and velocity of the last step, for output.
  virtual const grid::NodalField<dim>& nodal_sums() const = 0;
};

/// Constraints act in the order given; they must outlive the step.
template <int dim>
using Constraints = std::vector<grid::Constraint<dim>*>;

/// What a step works on; all must outlive it.
template <int dim, class Basis>
struct StepParts {
  const grid::Grid<dim>& grid;
  std::array<Basis, dim> bases;
  const grid::Walls<dim>& walls;
  particles::Particles<dim>& particles;
  particles::BoundaryParticles<dim>& boundary;
  const Constraints<dim>& constraints;
  Ledger<dim>& ledger;
};

/// Which velocities strain the particles, and when their stress is renewed.
enum class Scheme {
  musl,  ///< modified update stress last: nodal velocities mapped anew from the particles (Eq. 9)
  usl,   ///< update stress last: nodal velocities of Eq. 6
  usf    ///< update stress first: nodal velocities of the step's start, before the forces
};

/// The one table of schemes: makes the step of a scheme.
template <int dim, class Basis>
std::unique_ptr<Step<dim>> make_step(Scheme scheme, const StepParts<dim, Basis>& parts);

}  // namespace mpm::solver
