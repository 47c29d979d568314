#include "mpm/scene/WatchedParticle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/petsc/Session.hpp"

namespace mpm::scene {

WatchedParticle::WatchedParticle(const particles::Particles<2>& particles, const Vector<2>& x) {
  const auto view = particles.view();
  double nearest = std::numeric_limits<double>::max();
  std::int64_t id = -1;
  double volume = 0.0;
  for (int p = 0; p < view.count; ++p) {
    const double distance = std::hypot(view.position[0][p] - x[0], view.position[1][p] - x[1]);
    if (distance > nearest || (distance == nearest && view.id[p] > id)) continue;
    nearest = distance;
    id = view.id[p];
    volume = view.volume[p];
  }
  const bool mine = nearest == petsc::minimum(nearest);
  // Of equally near ones the smallest id, on whatever rank it is.
  const double smallest = petsc::minimum(mine ? static_cast<double>(id) : 1e300);
  m_id = static_cast<std::int64_t>(smallest);
  m_initial_volume = petsc::maximum(mine && id == m_id ? volume : 0.0);
}

std::vector<double> WatchedParticle::observe(const particles::Particles<2>& particles) const {
  std::vector<double> values(5, 0.0);
  {
    const auto view = particles.view();
    const auto p = std::find(view.id, view.id + view.count, m_id) - view.id;
    if (p < view.count) {
      SymmetricTensor stress;
      for (int k = 0; k < tensor_components<2>; ++k) stress[k] = view.stress[k][p];
      values = {std::sqrt(1.5) * norm(deviator(stress)), -trace(stress) / 3.0,
                -std::log(view.volume[p] / m_initial_volume), view.state[0][p], view.state[1][p]};
    }
  }
  for (double& value : values) value = petsc::sum(value);
  return values;
}

}  // namespace mpm::scene
