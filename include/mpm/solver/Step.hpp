#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "mpm/basis/BSpline.hpp"
#include "mpm/grid/NodalCondition.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/BoundaryParticles.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/solver/RunState.hpp"
#include "mpm/transfer/PointDeposit.hpp"
#include "mpm/transfer/Transfer.hpp"

namespace mpm::solver {

/// What a step needs besides grid and particles.
template <int dim>
struct StepOptions {
  transfer::BodyForce<dim> body_force;
  double damping = 0.0;  ///< local damping: f -= damping |f| sign(v) per component
  /// Time tau in which particle velocities turn into the grid's, s: FLIP keeps exp(-dt/tau) of
  /// them per step; infinite is pure FLIP, 0 pure PIC.
  double flip_time = std::numeric_limits<double>::infinity();

  double flip_share(double dt) const { return flip_time > 0.0 ? std::exp(-dt / flip_time) : 0.0; }
};

/// What a rank found out in a step; ranks have to agree on it before they act.
struct StepReport {
  bool must_migrate = false;
  int broken_particle = -1;  ///< left the grid or has no finite stress; -1 if none
};

/// One explicit step of the material point method, whatever its scheme and basis.
template <int dim>
class Step {
 public:
  virtual ~Step() = default;

  /// Advances grid and particles by state.dt. Collective.
  virtual StepReport advance(const RunState& state, const StepOptions<dim>& options) = 0;

  /// Smallest h_p / (c_p + |v_p|) over this rank's particles, s. Local.
  virtual double smallest_transit_time() const = 0;

  /// Sum over this rank's nodes of |f| after walls and conditions, without damping, in the last
  /// step, N.
  virtual double unbalanced_force() const = 0;

  virtual const transfer::PointDeposit<dim>& point_deposit() const = 0;

  /// Nodal mass and velocity of the last step, for output.
  virtual const grid::NodalField<dim>& nodal_sums() const = 0;
};

/// Conditions act in the order given; they must outlive the step.
template <int dim>
using Conditions = std::vector<grid::NodalCondition<dim>*>;

/// Modified update stress last, central differences (Eqs. 1-9).
template <int dim, class Basis>
class MuslStep : public Step<dim> {
 public:
  /// Collective. All that is referred to must outlive the step.
  MuslStep(const grid::Grid<dim>& grid, std::array<Basis, dim> bases, const grid::Walls<dim>& walls,
           particles::Particles<dim>& particles, particles::BoundaryParticles<dim>& boundary,
           const Conditions<dim>& conditions);

  StepReport advance(const RunState& state, const StepOptions<dim>& options) override;
  double smallest_transit_time() const override;
  double unbalanced_force() const override { return m_unbalanced_force; }
  const transfer::PointDeposit<dim>& point_deposit() const override { return m_point_deposit; }
  const grid::NodalField<dim>& nodal_sums() const override { return m_sums; }

 private:
  void update_momentum(const RunState& state, double damping);
  void apply_damping(double damping, double dt);
  void compute_velocity_and_acceleration();
  void constrain_remapped_momentum();
  int update_stress(const particles::ParticleView<dim>& view);

  const grid::Grid<dim>& m_grid;
  std::array<Basis, dim> m_bases;
  const grid::Walls<dim>& m_walls;
  particles::Particles<dim>& m_particles;
  particles::BoundaryParticles<dim>& m_boundary;
  const Conditions<dim>& m_conditions;
  transfer::BasisDeposit<dim, Basis> m_point_deposit;
  grid::NodalField<dim> m_sums;      ///< mass, momentum, force
  grid::NodalField<dim> m_rates;     ///< velocity, acceleration
  grid::NodalField<dim> m_remapped;  ///< momentum of Eq. 9, then its velocity
  transfer::Increments m_increments;
  double m_unbalanced_force = 0.0;
};

}  // namespace mpm::solver
