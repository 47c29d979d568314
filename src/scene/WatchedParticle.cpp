#include "mpm/scene/WatchedParticle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mpm/petsc/Session.hpp"

namespace mpm::scene {

WatchedParticle::Found WatchedParticle::nearest(const particles::Particles<2>& particles,
                                                const Vector<2>& x) {
  const auto view = particles.view();
  double nearest = std::numeric_limits<double>::max();
  Found found{-1, 0.0, 0};
  for (int p = 0; p < view.count; ++p) {
    const double distance = std::hypot(view.position[0][p] - x[0], view.position[1][p] - x[1]);
    if (distance > nearest || (distance == nearest && view.id[p] > found.id)) continue;
    nearest = distance;
    found = {view.id[p], view.volume[p], static_cast<int>(view.material[p])};
  }
  const bool mine = nearest == petsc::minimum(nearest);
  // Of equally near ones the smallest id, on whatever rank it is.
  const double smallest = petsc::minimum(mine ? static_cast<double>(found.id) : 1e300);
  const bool chosen = mine && found.id == static_cast<std::int64_t>(smallest);
  return {static_cast<std::int64_t>(smallest), petsc::maximum(chosen ? found.volume : 0.0),
          static_cast<int>(petsc::maximum(chosen ? found.material : 0))};
}

WatchedParticle::WatchedParticle(const particles::Particles<2>& particles, const Vector<2>& x)
    : WatchedParticle(nearest(particles, x), particles) {}

WatchedParticle::WatchedParticle(const Found& found, const particles::Particles<2>& particles)
    : m_id(found.id),
      m_initial_volume(found.volume),
      m_void_ratio(particles.state(found.material, "void_ratio")),
      m_eps_q(particles.state(found.material, "eps_q")) {}

std::vector<double> WatchedParticle::observe(const particles::Particles<2>& particles) const {
  std::vector<double> values(5, 0.0);
  {
    const auto view = particles.view();
    const auto p = std::find(view.id, view.id + view.count, m_id) - view.id;
    if (p < view.count) {
      const SymmetricTensor stress = view.stress_of(static_cast<int>(p));
      values = {std::sqrt(1.5) * norm(deviator(stress)), -trace(stress) / 3.0,
                -std::log(view.volume[p] / m_initial_volume), view[m_void_ratio][p],
                view[m_eps_q][p]};
    }
  }
  for (double& value : values) value = petsc::sum(value);
  return values;
}

}  // namespace mpm::scene
