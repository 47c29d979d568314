#pragma once

#include <functional>
#include <string>

#include "mpm/scene/RunLoop.hpp"

namespace mpm::scene {

/// How a body comes to rest under local damping.
struct Settling {
  std::string name;
  bool is_main = false;  ///< see Stage
  double damping = 0.7;
  double tolerance = 1e-3;      ///< the end: sum |f| as a share of the reference force
  double reference_force = 0;   ///< N; 0 stands for the weight
  long long longest = 200'000;  ///< steps, after which the run fails
  long long check_every = 50;   ///< steps
  /// Called with the present share at every check.
  std::function<void(double)> after_check = {};
};

/// Runs a stage with local damping until the forces on the nodes, damping apart, are small; damping
/// is off afterwards. `unbalanced` becomes the share reached. Returns false if the run as a whole
/// is over. Throws NumericalFailure after the longest time. Collective.
template <int dim>
bool settle(solver::Simulation<dim>& simulation, RunLoop<dim>& loop, const Settling& settling,
            double& unbalanced);

}  // namespace mpm::scene
