#include "ReversalCube.hpp"

namespace mpm::cases::reversal {

double CubeObserver::particle_volume(const ReversalOptions& options) {
  return std::pow(
      side / static_cast<double>(options.cells * options.run.particles_per_cell_direction), 3);
}

void CubeObserver::begin(const run::Moment<3>& now) {
  const auto& particles = now.simulation.particles();
  m_law = dynamic_cast<const SandLaw*>(particles.materials()[the_sand].get());
  m_sand.emplace(particles);
}

void CubeObserver::after_step(const run::Moment<3>& moment) {
  m_strain = moment.clock.dt * m_motion->next.D;
  if (m_options.run.scheme == solver::Scheme::usf) std::swap(m_strain, m_strain_to_come);
  std::unordered_map<std::int64_t, Before> now;
  {
    const auto view = moment.simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const auto before = m_before.find(view.id[p]);
      // Unknown are those that have just come from another rank.
      if (before != m_before.end()) check(view, p, before->second);
      now.emplace(view.id[p], state_of(view, p));
    }
  }
  m_before = std::move(now);
}

CubeObserver::Before CubeObserver::state_of(const particles::ParticleView<3>& view, int p) const {
  return {view[m_sand->eps_q][p], view.stress_of(p)};
}

void CubeObserver::check(const particles::ParticleView<3>& view, int p, const Before& before) {
  const Before now = state_of(view, p);
  const SandInvariants stress = m_law->invariants(now.stress);
  const double e = view[m_sand->void_ratio][p];
  const double gap = view[m_sand->gap_volume_ratio][p];
  const double floor = m_options.sand.parameters().pressure_floor;
  m_work += 0.5 * m_particle_volume * contract(before.stress + now.stress, m_strain);
  m_largest_gap = std::max(m_largest_gap, gap);
  const double skeleton = (1.0 + e) / (1.0 + m_options.sand.parameters().void_ratio);
  m_largest_volume_error =
      std::max(m_largest_volume_error,
               std::abs(view.volume[p] / (m_particle_volume * skeleton * gap) - 1.0));
  if (gap > 1.0) {
    const double difference = std::abs(stress.p_star - m_law->gap().p_star(gap));
    m_largest_gap_stress =
        std::max(m_largest_gap_stress, (difference + stress.q) / m_options.pressure);
  }
  if (gap > 1.0 || stress.p_star <= floor * (1.0 + floor_margin)) {
    ++m_at_floor;
    return;
  }
  const double qhat = m_law->surface().at({stress.p_star, e, now.eps_q, stress.sin3theta}).qhat;
  const bool is_plastic = now.eps_q > before.eps_q;
  ++(is_plastic ? m_plastic : m_elastic);
  const double outside = (stress.q - qhat) / stress.p_star;
  m_largest_distance = std::max(m_largest_distance, is_plastic ? std::abs(outside) : outside);
}

Mean CubeObserver::mean(const solver::Simulation<3>& simulation) const {
  SymmetricTensor stress;
  double e = 0.0, eps_q = 0.0;
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      stress += state_of(view, p).stress;
      e += view[m_sand->void_ratio][p];
      eps_q += view[m_sand->eps_q][p];
    }
  }
  const auto count = static_cast<double>(simulation.particles().global_count());
  for (double& component : stress.components)
    component = simulation.communicator().sum(component) / count;
  return {-trace(stress) / 3.0,
          std::sqrt(1.5) * norm(deviator(stress)),
          stress[3],
          simulation.communicator().sum(e) / count,
          simulation.communicator().sum(eps_q) / count,
          mean_gap(simulation)};
}

double CubeObserver::mean_pressure(const solver::Simulation<3>& simulation) const {
  double sum = 0.0;
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) sum -= trace(state_of(view, p).stress) / 3.0;
  }
  return simulation.communicator().sum(sum) /
         static_cast<double>(simulation.particles().global_count());
}

double CubeObserver::mean_gap(const solver::Simulation<3>& simulation) const {
  double sum = 0.0;
  {
    const auto view = simulation.particles().view();
    for (int p = 0; p < view.count; ++p) sum += view[m_sand->gap_volume_ratio][p];
  }
  return simulation.communicator().sum(sum) /
         static_cast<double>(simulation.particles().global_count());
}

void CubeObserver::report(const petsc::Communicator& ranks, io::Summary& summary) const {
  summary.set("error_surface", ranks.maximum(m_largest_distance));
  summary.set("error_volume", ranks.maximum(m_largest_volume_error));
  summary.set("stress_in_gap_max", ranks.maximum(m_largest_gap_stress));
  summary.set("gap_volume_ratio_max", ranks.maximum(m_largest_gap));
  const auto plastic = ranks.sum(m_plastic), elastic = ranks.sum(m_elastic);
  const auto at_floor = ranks.sum(m_at_floor);
  const auto all = static_cast<double>(std::max(1LL, plastic + elastic + at_floor));
  summary.set("share_plastic", static_cast<double>(plastic) / all);
  summary.set("share_at_floor", static_cast<double>(at_floor) / all);
}

void CubeObserver::persist(Archive& archive) {
  archive("strain", m_strain.components);
  archive("strain_to_come", m_strain_to_come.components);
  archive.sum("work", m_work);
  archive.largest("largest_distance", m_largest_distance);
  archive.largest("largest_gap_stress", m_largest_gap_stress);
  archive.largest("largest_volume_error", m_largest_volume_error);
  archive.largest("largest_gap", m_largest_gap);
  archive.sum("plastic", m_plastic);
  archive.sum("elastic", m_elastic);
  archive.sum("at_floor", m_at_floor);
  persist_particles(archive);
}

void CubeObserver::persist_particles(Archive& archive) {
  constexpr std::size_t width = 2 + SymmetricTensor::size;
  std::vector<double> values;
  for (const auto& [id, before] : m_before) {
    values.insert(values.end(), {static_cast<double>(id), before.eps_q});
    values.insert(values.end(), before.stress.components.begin(), before.stress.components.end());
  }
  archive.list("particles", values);
  if (!archive.gives()) return;
  m_before.clear();
  for (std::size_t k = 0; k + width <= values.size(); k += width) {
    Before before{values[k + 1], {}};
    for (int c = 0; c < SymmetricTensor::size; ++c)
      before.stress[c] = values[k + 2 + static_cast<std::size_t>(c)];
    m_before.emplace(static_cast<std::int64_t>(values[k]), before);
  }
}

}  // namespace mpm::cases::reversal
