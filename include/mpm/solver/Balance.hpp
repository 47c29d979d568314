#pragma once

#include "mpm/basis/BSpline.hpp"
#include "mpm/partition/Layout.hpp"
#include "mpm/petsc/Communicator.hpp"

namespace mpm::solver {

/// How cells are shared out over the ranks.
enum class LoadBalance {
  ranges,  ///< ranges of nodes in every direction
  metis    ///< blocks of cells, in parts by METIS
};

struct BalanceOptions {
  LoadBalance method = LoadBalance::ranges;
  /// Cells are shared out anew where a rank has so many times the mean number of particles; 0
  /// never.
  double rebalance_above = 1.1;
  int steps_between_checks = 100;
};

/// Shares out the cells of a grid by the particles in them. Depends on their numbers only, never on
/// times: a run repeats itself.
template <int dim>
class Balance {
 public:
  Balance(const petsc::Communicator& communicator, const std::array<basis::NodeLine, dim>& nodes,
          const BalanceOptions& options);

  /// Balanced ranges. Throws BadInput if the grid is too small for so many ranks. Local.
  partition::Layout<dim> ranges(const partition::CellWork<dim>& particles) const;
  /// Who should own the cells, after `previous` has. Collective.
  partition::Ownership<dim> ownership(const partition::CellWork<dim>& particles,
                                      const partition::Ownership<dim>& previous) const;

  /// Whether the balance is to be looked at before the next step.
  bool is_due(long long step) const;
  double rebalance_above() const { return m_options.rebalance_above; }

 private:
  petsc::Communicator m_communicator;
  partition::LayoutRequest<dim> m_request;  ///< without work
  BalanceOptions m_options;
};

extern template class Balance<1>;
extern template class Balance<2>;
extern template class Balance<3>;

}  // namespace mpm::solver
