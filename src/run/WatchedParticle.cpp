#include "mpm/run/WatchedParticle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm::run {

template <int dim>
void WatchedParticle<dim>::begin(const Moment<dim>& moment) {
  const particles::Particles<dim>& particles = moment.simulation.particles();
  find(particles);
  for (const std::string& needed : m_states) particles.state(m_material, needed);
}

template <int dim>
void WatchedParticle<dim>::find(const particles::Particles<dim>& particles) {
  const petsc::Communicator& ranks = particles.communicator();
  const auto view = particles.view();
  double nearest = std::numeric_limits<double>::max();
  int found = -1;
  for (int p = 0; p < view.count; ++p) {
    double square = 0.0;
    for (int d = 0; d < dim; ++d)
      square += (view.position[d][p] - m_near[d]) * (view.position[d][p] - m_near[d]);
    const double distance = std::sqrt(square);
    if (distance > nearest || (distance == nearest && view.id[p] > view.id[found])) continue;
    nearest = distance;
    found = p;
  }
  const bool mine = found >= 0 && nearest == ranks.minimum(nearest);
  // Of equally near ones the smallest id, on whatever rank it is.
  const double smallest = ranks.minimum(mine ? static_cast<double>(view.id[found]) : 1e300);
  m_id = static_cast<std::int64_t>(smallest);
  const bool chosen = mine && view.id[found] == m_id;
  m_initial_volume = ranks.maximum(chosen ? view.volume[found] : 0.0);
  m_material = ranks.maximum(chosen ? static_cast<int>(view.material[found]) : 0);
}

/// All that observe() gives, in its order.
template <int dim>
std::vector<double> WatchedParticle<dim>::look_at(const particles::Particles<dim>& particles,
                                                  const particles::ParticleView<dim>& view,
                                                  int p) const {
  std::vector<double> values;
  for (int d = 0; d < dim; ++d) values.push_back(view.position[d][p]);
  for (int d = 0; d < dim; ++d) values.push_back(view.displacement[d][p]);
  const SymmetricTensor stress = view.stress_of(p);
  values.insert(values.end(),
                {std::sqrt(1.5) * norm(deviator(stress)), -trace(stress) / 3.0,
                 -std::log(view.volume[p] / m_initial_volume), view.deviatoric_strain[p]});
  for (const std::string& state : m_states)
    values.push_back(view[particles.state(m_material, state)][p]);
  return values;
}

template <int dim>
Watched<dim> WatchedParticle<dim>::observe(const particles::Particles<dim>& particles) const {
  std::vector<double> values(2 * dim + 4 + m_states.size(), 0.0);
  {
    const auto view = particles.view();
    const auto p = std::find(view.id, view.id + view.count, m_id) - view.id;
    if (p < view.count) values = look_at(particles, view, static_cast<int>(p));
  }
  particles.communicator().sum(values);  // of one value and zeros
  Watched<dim> seen{.q = values[2 * dim],
                    .p = values[2 * dim + 1],
                    .volumetric_strain = values[2 * dim + 2],
                    .deviatoric_strain = values[2 * dim + 3],
                    .states = {values.begin() + 2 * dim + 4, values.end()}};
  for (std::size_t d = 0; d < dim; ++d) {
    seen.position[d] = values[d];
    seen.displacement[d] = values[dim + d];
  }
  return seen;
}

template <int dim>
void WatchedParticle<dim>::persist(Archive& archive) {
  archive("id", m_id);
  archive("initial_volume", m_initial_volume);
  archive("material", m_material);
}

template class WatchedParticle<1>;
template class WatchedParticle<2>;
template class WatchedParticle<3>;

}  // namespace mpm::run
