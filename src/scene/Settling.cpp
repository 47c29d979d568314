#include "mpm/scene/Settling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mpm/core/Errors.hpp"

namespace mpm::scene {
namespace {

template <int dim>
double share_of_forces(const solver::Simulation<dim>& simulation, double reference_force) {
  if (reference_force == 0.0) return simulation.out_of_balance();
  return simulation.unbalanced_force() / reference_force;
}

}  // namespace

template <int dim>
bool settle(solver::Simulation<dim>& simulation, RunLoop<dim>& loop, const Settling& settling,
            double& unbalanced) {
  unbalanced = 1.0;
  const auto check = [&] {
    const long long steps = loop.clock().steps_in_stage;
    if (steps % settling.check_every != 0) return;
    unbalanced = std::min(1.0, share_of_forces(simulation, settling.reference_force));
    if (settling.after_check) settling.after_check(unbalanced);
    if (steps >= settling.longest)
      throw NumericalFailure(fmt::format(
          "{}: no rest, out of balance {:.3g} after {} steps where {:.3g} is asked for; "
          "a larger tolerance or another damping may help",
          settling.name, unbalanced, steps, settling.tolerance));
  };
  simulation.set_damping(settling.damping);
  const bool goes_on =
      loop.run({.name = settling.name,
                .share_done = [&] { return std::log(unbalanced) / std::log(settling.tolerance); },
                .after_step = check,
                .status = [&] { return fmt::format("out of balance {:.2e}", unbalanced); },
                .is_main = settling.is_main});
  simulation.set_damping(0.0);
  return goes_on;
}

template bool settle<1>(solver::Simulation<1>&, RunLoop<1>&, const Settling&, double&);
template bool settle<2>(solver::Simulation<2>&, RunLoop<2>&, const Settling&, double&);
template bool settle<3>(solver::Simulation<3>&, RunLoop<3>&, const Settling&, double&);

}  // namespace mpm::scene
