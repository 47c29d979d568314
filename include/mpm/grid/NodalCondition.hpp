#pragma once

#include <algorithm>
#include <array>
#include <span>

#include "mpm/grid/Grid.hpp"

namespace mpm::grid {

/// Mass, momentum and, in the first mapping of a step, force on a rank's nodes.
template <int dim>
struct NodalMotion {
  const double* mass;
  std::array<double*, dim> momentum;
  /// Null in the second mapping (Eq. 9), where no impulse reaches the particles.
  std::array<double*, dim> force{};
  /// Time over which the force has changed the momentum, s.
  double dt = 0.0;

  bool is_first_mapping() const { return force[0] != nullptr; }
};

/// Something that acts on the motion of nodes in both mappings of a step: a rigid body, a
/// prescribed velocity.
template <int dim>
class NodalCondition {
 public:
  virtual ~NodalCondition() = default;
  /// Called before every step, while particles may be looked at. Local.
  virtual void prepare_step() {}
  /// Called once per step before the first mapping's nodes are corrected. Collective.
  virtual void begin_step() {}
  /// Corrects momentum, and force where there is one, of owned nodes. Local.
  virtual void correct(const Grid<dim>& grid, const NodalMotion<dim>& motion) = 0;
  /// Local nodes on which the last correction acted; these are not damped.
  virtual std::span<const int> acted_nodes() const { return {}; }
  bool acts_on(int local_node) const {
    return std::ranges::find(acted_nodes(), local_node) != acted_nodes().end();
  }
};

}  // namespace mpm::grid
