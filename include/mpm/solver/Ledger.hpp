#pragma once

#include <string>
#include <vector>

#include "mpm/core/Archive.hpp"
#include "mpm/core/Tensor.hpp"
#include "mpm/petsc/Communicator.hpp"

namespace mpm::solver {

/// What one cause has done to the particles, this rank's share.
template <int dim>
struct Cause {
  std::string name;
  Vector<dim> impulse{};  ///< N s (per metre in plane strain)
  double work = 0.0;      ///< J
};

/// The state of the particles that a ledger is held against.
template <int dim>
struct ParticleSums {
  Vector<dim> momentum{};  ///< N s
  double kinetic = 0.0;    ///< J
  double motion = 0.0;     ///< sum of m |v|, N s
};

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

  /// Forgets all, so that a stage can begin from rest.
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
  double internal_work = 0.0;   ///< J, of the stresses on the grid
  double kinetic_change = 0.0;  ///< J, of the particles
  /// What the transfers between particles and grid have added, J; negative where they dissipate.
  double kinetic_residual = 0.0;
  /// Of the particles' momentum: its change less all impulses, N s.
  Vector<dim> momentum_residual{};
  /// Its size over the sum of the sizes of all impulses and of m |v| over the particles, at the
  /// start and now.
  double momentum_residual_share = 0.0;
};

/// Collective.
template <int dim>
LedgerReport<dim> report(const Ledger<dim>& ledger, const ParticleSums<dim>& now,
                         const petsc::Communicator& ranks);

extern template class Ledger<1>;
extern template class Ledger<2>;
extern template class Ledger<3>;

}  // namespace mpm::solver
