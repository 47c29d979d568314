#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mpm/basis/Bases.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/BoundaryParticles.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/particles/Seeding.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/solver/Balance.hpp"
#include "mpm/solver/Regularisation.hpp"
#include "mpm/solver/Step.hpp"
#include "mpm/solver/StepTimes.hpp"

namespace mpm::solver {

/// What a scene puts together to get a simulation.
template <int dim>
struct SimulationSetup {
  std::array<basis::KnotLines, dim> lines;
  basis::Kind basis = basis::Kind::cubic;
  basis::EndTreatment ends = basis::EndTreatment::mirror;
  int particles_per_cell = 2;  ///< per direction: the extent of uGIMP's particles
  Scheme scheme = Scheme::musl;
  typename grid::Walls<dim>::Kinds walls{};
  particles::Materials materials = {};
  particles::Filling<dim> filling = {};
  Vector<dim> gravity{};  ///< m/s^2
  double courant = 0.9;   ///< share of h/(c + |v|)
  Transfer transfer = Transfer::flip;
  double flip_time = std::numeric_limits<double>::infinity();  ///< s, see StepOptions
  double averaged_volume_share = 0.0;                          ///< see StepOptions
  std::vector<std::string> particle_contacts = {};  ///< labels of contacts found at particles
  RegularisationOptions regularisation = {};
  BalanceOptions balance = {};
  /// The ranks that share the run; the caller's, see petsc::Communicator.
  petsc::Communicator communicator = petsc::world();
};

/// Grid, particles and step of one run. What time it is, the run knows: see run/Clock.hpp.
template <int dim>
class Simulation {
 public:
  /// Lays out the grid over the ranks, seeds the particles. Collective.
  explicit Simulation(const SimulationSetup<dim>& setup);

  /// The length of the next step, s: the stable one, renewed when due, or `limit`, e.g. to end at a
  /// given time. Renews the balance of the ranks when due. Throws NumericalFailure on all ranks
  /// where the stable step collapses or a particle is far faster than its waves. Collective.
  double plan(double limit = std::numeric_limits<double>::max());

  /// Advances from `time` by one step of dt, which plan() has given; keeps particles sorted and on
  /// their ranks. Returns the times of the step. Throws NumericalFailure on all ranks if a particle
  /// left the grid or a stress is not finite, naming the particle. Collective.
  StepTimes advance(double time, double dt);

  /// What this rank tells all others in the course of the next step, without a message of its own:
  /// bits, of which there are heard_bits. Local.
  void tell(int bits) { m_told = bits; }
  /// The bits that any rank told in the last step.
  int heard() const { return m_heard; }
  static constexpr int heard_bits = 4;

  /// Sets velocities, displacements and accumulated strain to zero and halves the next change of
  /// momentum: the start of a stage from rest. Collective.
  void start_from_rest();

  /// As if the last step had had this length, s. Local.
  void assume_last_step(double dt) { m_dt_old = dt; }

  /// Rigid bodies and the like, which act on nodes in the order they were added.
  void add_constraint(std::shared_ptr<grid::Constraint<dim>> constraint);
  /// Saves or puts back what constraints know between steps.
  void persist_constraints(Archive& archive);

  /// Saves or puts back what is known between steps, but for the particles and who owns which
  /// cells; these have to be put back before.
  void persist(Archive& archive);
  /// Takes particles that have been put back as they were on the same ranks, which owned these
  /// cells. Throws BadInput where they cannot have. Local.
  void keep_layout(const partition::Ownership<dim>& ownership);
  /// Shares out the cells by the particles, wherever these are, and sends them there. Collective.
  void share_out();

  void set_damping(double damping) { m_options.damping = damping; }
  void set_gravity(const Vector<dim>& gravity) { m_options.body_force.uniform = gravity; }
  const Vector<dim>& gravity() const { return m_options.body_force.uniform; }
  /// A body force that depends on the undeformed position and on time, in place of gravity; m/s^2.
  void set_body_force(std::function<Vector<dim>(const Vector<dim>&, double time)> field) {
    m_body_force = std::move(field);
  }

  /// Steps taken so far.
  long long steps() const { return m_steps; }
  const petsc::Communicator& communicator() const { return m_grid->communicator(); }
  const grid::Grid<dim>& grid() const { return *m_grid; }
  const grid::Walls<dim>& walls() const { return m_walls; }
  particles::Particles<dim>& particles() { return *m_particles; }
  const particles::Particles<dim>& particles() const { return *m_particles; }
  /// Loaded surfaces; none at the start.
  particles::BoundaryParticles<dim>& boundary() { return *m_boundary; }
  const particles::BoundaryParticles<dim>& boundary() const { return *m_boundary; }
  const Step<dim>& step() const { return *m_step; }

  /// Momentum and energy by cause since the ledger was opened: at the start of the run, or of a
  /// stage that began at rest. Collective.
  LedgerReport<dim> ledger() const { return report(m_ledger, particle_sums(), communicator()); }
  /// Opens it anew; after particles have been given velocities by hand. Collective.
  void open_ledger();
  void persist_ledger(Archive& archive) { m_ledger.persist(archive); }
  void persist_regularisation(Archive& archive) {
    if (m_regularisation) m_regularisation->persist(archive);
  }

  /// Sum of |f| over all nodes without damping, N. Collective.
  double unbalanced_force() const;
  /// The same as a share of the weight sum m g. Collective.
  double out_of_balance() const;
  /// Sum of m v^2/2 over all particles, J. Collective.
  double kinetic_energy() const;
  Vector<dim> momentum() const;
  double total_mass() const;
  /// Largest over mean number of particles of a rank. Collective.
  double imbalance() const;
  /// How often cells have got new owners since the start.
  int rebalancings() const { return m_rebalancings; }

 private:
  std::unique_ptr<grid::Grid<dim>> make_grid(const SimulationSetup<dim>& setup) const;
  std::unique_ptr<Step<dim>> make_step(const SimulationSetup<dim>& setup);
  void seed(const SimulationSetup<dim>& setup);
  void declare_causes();
  ParticleSums<dim> particle_sums() const;
  std::optional<double> strain_energy(const particles::ParticleView<dim>& view) const;
  void rebalance();
  void migrate();
  void renew_time_step();
  int agreed(int mine);
  void agree(const StepReport& report, const StepTimes& times);
  /// What has made a run impossible to go on with.
  enum class Fault { broken, runaway, collapsed_step };
  [[noreturn]] void stop_at(int particle, Fault fault, const StepTimes& times) const;
  /// What is wrong with a particle, and what may help.
  struct Diagnosis {
    std::string kind, what, remedy;
  };
  Diagnosis diagnose(int particle, Fault fault, double wave_speed, const StepTimes& times) const;
  std::string describe(int particle, Fault fault, const StepTimes& times) const;
  double wave_speed_of(int particle) const;

  Balance<dim> m_balance;
  std::unique_ptr<grid::Grid<dim>> m_grid;
  grid::Walls<dim> m_walls;
  std::unique_ptr<particles::Particles<dim>> m_particles;
  std::unique_ptr<particles::BoundaryParticles<dim>> m_boundary;
  std::unique_ptr<Regularisation<dim>> m_regularisation;  ///< null where softening is left alone
  std::vector<std::shared_ptr<grid::Constraint<dim>>> m_owned_constraints;
  Constraints<dim> m_constraints;
  Ledger<dim> m_ledger;
  std::unique_ptr<Step<dim>> m_step;
  StepOptions<dim> m_options;
  double m_courant, m_largest_courant;
  std::function<Vector<dim>(const Vector<dim>&, double)> m_body_force;
  double m_stable_dt = 0.0;  ///< s, as last renewed
  double m_first_dt = 0.0;   ///< s, the first stable one
  double m_dt_old = 0.0;     ///< s, of the last step; 0 halves the next change of momentum
  long long m_steps = 0;
  int m_steps_since_renewal = 0;  ///< of the stable dt
  int m_steps_since_sort = 0;
  int m_rebalancings = 0;
  int m_told = 0, m_heard = 0;
};

extern template class Simulation<1>;
extern template class Simulation<2>;
extern template class Simulation<3>;

}  // namespace mpm::solver
