#pragma once

#include "mpm/solver/Step.hpp"
#include "mpm/transfer/SurfaceLoad.hpp"

namespace mpm::solver {

/// The parts of which explicit schemes are made, each with its communication.
template <int dim, class Basis>
class ExplicitStep : public Step<dim> {
 public:
  /// Collective.
  explicit ExplicitStep(const StepParts<dim, Basis>& parts);

  Transit transit() const override;
  double unbalanced_force() const override { return m_unbalanced_force; }
  const transfer::PointDeposit<dim>& point_deposit() const override { return m_point_deposit; }
  const grid::NodalField<dim>& nodal_sums() const override { return m_sums; }

 protected:
  using View = particles::ParticleView<dim>;

  View particles() const { return m_parts.particles.view(); }

  /// Nodal mass, momentum and force of the particles (Eqs. 1-5). Collective.
  void deposit(const View& particles, const StepOptions<dim>& options);
  /// Nodal momentum, velocity and acceleration after forces, walls and constraints (Eq. 6).
  /// Collective.
  void update_momentum(const View& particles, const StepTimes& times,
                       const StepOptions<dim>& options);
  /// Particle velocities (Eq. 7). Local.
  void update_velocities(const View& particles, const StepTimes& times,
                         const StepOptions<dim>& options);
  /// Particle velocities, and nodal velocities mapped anew from them (Eqs. 7, 9). Collective.
  void update_velocities_and_remap(const View& particles, const StepTimes& times,
                                   const StepOptions<dim>& options);
  /// Velocities for strains from the momenta just deposited, before any force. Collective.
  void take_deposited_velocities();
  /// Strains and moves the particles (Eq. 8), renews volume and stress. `strain_velocity` is one of
  /// the two below. Collective where volume changes are averaged.
  StepReport strain_and_move(const View& particles, const transfer::AdvanceTimes& dt,
                             const transfer::NodalVector<dim>& strain_velocity,
                             const StepOptions<dim>& options);

  transfer::NodalVector<dim> remapped_velocity() { return transfer::NodalVector<dim>(m_remapped); }
  transfer::NodalVector<dim> updated_velocity() {
    return {transfer::VelocityAcceleration<dim>(m_rates).velocity};
  }

 private:
  void invert_mass();
  void constrain(grid::ConstrainedNodes<dim> nodes);
  void sum_unbalanced_force();
  // What a momentum update books, see StepLedger.cpp.
  void book_deposits(double dt);
  void book_walls(double flip_share, double dt);
  void book_constraints(double dt);
  void book_work(double dt);
  void book_loads_work(double dt);
  void book_body_force_work(const View& particles, double dt);
  double mean_velocity(int d, int I, double dt) const;
  using WallHolds = std::vector<typename grid::Walls<dim>::Held>;
  void apply_damping(double damping, double dt);
  void compute_velocity_and_acceleration();
  void constrain_remapped_momentum();
  int update_stress(const View& particles);
  transfer::Drift gather(const View& particles, const particles::Range& range,
                         const transfer::AdvanceTimes& dt,
                         const transfer::NodalVector<dim>& strain_velocity);
  StepReport strain_and_move_block(const View& particles, const particles::Range& block,
                                   const transfer::AdvanceTimes& dt,
                                   const transfer::NodalVector<dim>& strain_velocity);
  StepReport strain_with_averages_and_move(const View& particles, const transfer::AdvanceTimes& dt,
                                           const transfer::NodalVector<dim>& strain_velocity,
                                           double share);
  /// theta_p <- share times the mean over the particle's surroundings + the rest of its own.
  /// Collective.
  void average_volume_change(const View& particles, double share);
  /// Nodal mass before anything else, for bases whose gradient depends on it. Collective.
  void find_mass(const View& particles);
  transfer::Stencil<dim, Basis> stencil() const {
    return {m_parts.grid, m_parts.bases, m_mass ? m_mass->values(0) : nullptr};
  }

  StepParts<dim, Basis> m_parts;
  transfer::BasisDeposit<dim, Basis> m_point_deposit;
  grid::NodalField<dim> m_sums;                            ///< mass, momentum, force
  grid::NodalField<dim> m_rates;                           ///< velocity, acceleration
  grid::NodalField<dim> m_remapped;                        ///< momentum of Eq. 9, then its velocity
  std::unique_ptr<grid::NodalField<dim>> m_volume_change;  ///< volume and its change, if averaged
  std::unique_ptr<grid::NodalField<dim>> m_mass;           ///< for dual bases
  transfer::ParticleBodyForce<dim> m_body_force;           ///< of the present step
  transfer::Increments m_increments;
  std::vector<double> m_inverse_mass;  ///< of the nodes of m_sums; 0 where there is no mass
  double m_unbalanced_force = 0.0;
  Vector<dim> m_load{};        ///< deposited by loaded surfaces in the present step, N
  WallHolds m_folded, m_held;  ///< by walls in the present step, before and after constraints
  std::array<std::vector<double>, dim> m_undamped;  ///< momentum; empty without damping
};

}  // namespace mpm::solver
