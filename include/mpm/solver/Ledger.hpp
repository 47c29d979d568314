#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mpm/core/Archive.hpp"
#include "mpm/core/Tensor.hpp"
#include "mpm/petsc/Communicator.hpp"

namespace mpm::solver {

/// What one cause has done to the particles, this rank's share.
template <int dim>
struct Cause {
  std::string name;
  Vector<dim> impulse{};   ///< N s (per metre in plane strain)
  double work = 0.0;       ///< J
  bool is_body = false;    ///< a constraint, with a motion of its own
  double body_work = 0.0;  ///< J, that part of the work which the motion of the body itself does
};

/// The state of the particles that a ledger is held against, of a rank or of all.
template <int dim>
struct ParticleSums {
  Vector<dim> momentum{};        ///< N s
  double kinetic = 0.0;          ///< J
  double motion = 0.0;           ///< sum of m |v|, N s
  std::optional<double> strain;  ///< energy, J; nothing where a law present has none
};

/// A rank's share becomes the sum over the ranks, in one message. Collective.
template <int dim>
ParticleSums<dim> summed(ParticleSums<dim> share, const petsc::Communicator& ranks);

/// Linear momentum and energy by cause since the ledger was opened, from nodal sums. With p- the
/// momentum deposited on a node, p+ that after forces, walls, constraints and damping, and
/// v = (v- + v+)/2 = v+ - a dt/2, a cause that gives a node the momentum dp does the work dp . v,
/// and all works together are the change of the nodes' kinetic energy. Internal forces give no
/// momentum (the functions' gradients sum to zero), and their work is what the others leave.
template <int dim>
class Ledger {
 public:
  /// The cause of that name, made where it is new.
  Cause<dim>& cause(const std::string& name);
  const std::vector<Cause<dim>>& causes() const { return m_causes; }

  /// Work of all nodal forces in a step, J.
  void add_total_work(double work) { m_total_work += work; }
  double total_work() const { return m_total_work; }

  /// Forgets all, so that a stage can begin from rest. `start` is that of all ranks.
  void open(const ParticleSums<dim>& start);
  const ParticleSums<dim>& start() const { return m_start; }

  void persist(Archive& archive);

 private:
  std::vector<Cause<dim>> m_causes;
  double m_total_work = 0.0;
  ParticleSums<dim> m_start;
};

/// The name under which a wall is booked, 2 d + side: wall_left, wall_right, wall_bottom, ...
std::string wall_cause(int wall);

/// A ledger summed over the ranks.
template <int dim>
struct LedgerReport {
  std::vector<Cause<dim>> causes;
  double internal_work = 0.0;  ///< J, of the stresses on the grid; negative where they take it up
  std::optional<double> strain_change;  ///< J, of the particles, if all laws have strain energy
  /// J, what the stresses have taken up beyond that, positive: -internal_work - strain_change. All
  /// errors of stress integration and of volumes are in it.
  std::optional<double> plastic_work;
  /// J, of kinetic and strain energy lost in the material and by the method, positive: plastic_work
  /// - kinetic_residual, in which what the nodes' noise adds to both cancels.
  std::optional<double> dissipation;
  std::optional<double> work_of_bodies;  ///< J, of the bodies' own motion, if there are bodies
  std::optional<double> friction_work;   ///< J, of the bodies beyond that: at their surfaces
  double kinetic_change = 0.0;           ///< J, of the particles
  /// What the transfers between particles and grid have added, J; negative where they dissipate.
  double kinetic_residual = 0.0;
  /// Of the particles' momentum: its change less all impulses, N s.
  Vector<dim> momentum_residual{};
  /// Its size over the sum of the sizes of all impulses and of m |v| over the particles, at the
  /// start and now.
  double momentum_residual_share = 0.0;
};

/// `now` is this rank's share of the particles. One message. Collective.
template <int dim>
LedgerReport<dim> report(const Ledger<dim>& ledger, ParticleSums<dim> now,
                         const petsc::Communicator& ranks);

/// All of a report by name and unit (work_gravity_J, impulse_loads_x_N_s, internal_work_J, ...), in
/// an order and number that stay the same during a run.
template <int dim>
std::vector<std::pair<std::string, double>> entries(const LedgerReport<dim>& report);

extern template class Ledger<1>;
extern template class Ledger<2>;
extern template class Ledger<3>;

}  // namespace mpm::solver
