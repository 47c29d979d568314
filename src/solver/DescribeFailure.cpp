#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mpm/core/Errors.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::solver {
namespace {

constexpr int cells_around = 2;

template <int dim>
bool is_finite(const Vector<dim>& vector) {
  return std::ranges::all_of(vector, [](double component) { return std::isfinite(component); });
}

template <int dim>
double length(const Vector<dim>& vector) {
  double square = 0.0;
  for (const double component : vector) square += component * component;
  return std::sqrt(square);
}

template <int dim>
nlohmann::ordered_json to_json(const Vector<dim>& vector) {
  return std::vector<double>(vector.begin(), vector.end());
}

template <int dim>
double pressure(const particles::ParticleView<dim>& view, int p) {
  return -(view.stress[0][p] + view.stress[1 % tensor_components<dim>][p] +
           view.stress[2 % tensor_components<dim>][p]) /
         3.0;
}

/// Smallest and largest of what is a number.
struct Extremes {
  void add(double value) {
    if (!std::isfinite(value)) return;
    smallest = std::min(smallest, value);
    largest = std::max(largest, value);
  }
  nlohmann::ordered_json json() const {
    if (smallest > largest) return nullptr;
    return {smallest, largest};
  }
  double smallest = std::numeric_limits<double>::infinity();
  double largest = -std::numeric_limits<double>::infinity();
};

/// The other particles of this rank in the cells around one; none where it has no place.
template <int dim>
nlohmann::ordered_json neighbours(const particles::ParticleView<dim>& view,
                                  const grid::Grid<dim>& grid, int p) {
  const auto centre = grid.cell_of(view.position_of(p));
  const auto is_near = [&](int other) {
    if (other == p || !is_finite<dim>(view.position_of(other))) return false;
    const auto cell = grid.cell_of(view.position_of(other));
    for (int d = 0; d < dim; ++d)
      if (std::abs(cell[d] - centre[d]) > cells_around) return false;
    return true;
  };
  int count = 0;
  Extremes speeds, pressures;
  for (int other = 0; is_finite<dim>(view.position_of(p)) && other < view.count; ++other) {
    if (!is_near(other)) continue;
    ++count;
    speeds.add(length<dim>(view.velocity_of(other)));
    pressures.add(pressure<dim>(view, other));
  }
  return {{"within_cells", cells_around},
          {"count", count},
          {"speed_m_per_s", speeds.json()},
          {"pressure_Pa", pressures.json()}};
}

/// What a particle is and has.
template <int dim>
void add_particle(const particles::Particles<dim>& particles,
                  const particles::ParticleView<dim>& view, int p,
                  nlohmann::ordered_json& details) {
  details["particle"] = view.id[p];
  details["position_m"] = to_json<dim>(view.position_of(p));
  details["velocity_m_per_s"] = to_json<dim>(view.velocity_of(p));
  details["volume_m3"] = view.volume[p];
  for (int k = 0; k < tensor_components<dim>; ++k)
    details["stress_Pa"].push_back(view.stress[k][p]);
  const auto material = static_cast<int>(view.material[p]);
  details["material"] = material;
  const auto& law = *particles.materials()[static_cast<std::size_t>(material)];
  for (const auto& variable : law.state_variables())
    details["state"][variable.name] = view[particles.state(material, variable.name)][p];
}

}  // namespace

/// What waves of compression have in a particle, m/s.
template <int dim>
double Simulation<dim>::wave_speed_of(int p) const {
  const particles::ParticleView<dim> view = m_particles->view();
  const auto material = static_cast<int>(view.material[p]);
  const material::Batch batch = m_particles->batch_of(view, material, {p, p + 1});
  std::vector<double> modulus(1);
  m_particles->materials()[static_cast<std::size_t>(material)]->wave_modulus(batch, modulus);
  return std::sqrt(modulus[0] * view.volume[p] / view.mass[p]);
}

/// The first rank that has such a particle describes it to all.
template <int dim>
void Simulation<dim>::stop_at(int particle, Fault fault, const StepTimes& times) const {
  std::string text =
      communicator().first_text(particle >= 0 ? describe(particle, fault, times) : "");
  if (text.empty()) text = failure_kind("time_step_collapsed", "a smaller -courant");
  const auto details = nlohmann::json::parse(text);
  throw NumericalFailure(
      details.value("message", fmt::format("the time step collapsed at step {}", m_steps)), text);
}

template <int dim>
typename Simulation<dim>::Diagnosis Simulation<dim>::diagnose(int p, Fault fault, double wave_speed,
                                                              const StepTimes& times) const {
  const particles::ParticleView<dim> view = m_particles->view();
  const Vector<dim> x = view.position_of(p), v = view.velocity_of(p);
  if (fault == Fault::collapsed_step)
    return {"time_step_collapsed",
            fmt::format("lets the time step collapse to {:.3g} s, the first was {:.3g} s,",
                        times.dt, m_first_dt),
            "a smaller -courant, or a law that does not stiffen without bounds"};
  if (fault == Fault::runaway)
    return {"runaway_velocity",
            fmt::format("moves with {:.3g} m/s, far faster than its waves of {:.3g} m/s,",
                        length<dim>(v), wave_speed),
            "a smaller -courant, or a slower motion"};
  if (!is_finite<dim>(x) || !is_finite<dim>(v))
    return {"not_a_number", "lost its position", "a smaller -courant"};
  if (!m_grid->all_cells().contains(m_grid->cell_of(x)))
    return {"particle_lost", "left the grid or lost its position",
            "a larger domain or a slower motion; a smaller -courant where the run is unstable"};
  return {"law_cannot_follow", "has a stress that is not a number",
          "a smaller -courant or a slower motion, so that a step strains less"};
}

template <int dim>
std::string Simulation<dim>::describe(int p, Fault fault, const StepTimes& times) const {
  const double c = wave_speed_of(p);  // the columns are lent once at a time
  Diagnosis diagnosis = diagnose(p, fault, c, times);
  if (m_courant > m_largest_courant)
    diagnosis.remedy = fmt::format(
        "a smaller -courant: it is {:.4g}, and {:.3g} is the largest at which this basis, update "
        "and transfer are stable",
        m_courant, m_largest_courant);
  const particles::ParticleView<dim> view = m_particles->view();
  nlohmann::ordered_json details;
  details["kind"] = diagnosis.kind;
  details["message"] = fmt::format("particle {} {} in step {}, x = ({:.6g}); what may help: {}",
                                   view.id[p], diagnosis.what, m_steps + 1,
                                   fmt::join(view.position_of(p), ", "), diagnosis.remedy);
  details["try"] = diagnosis.remedy;
  details["step"] = m_steps + 1;
  details["last_good_step"] = m_steps;
  if (fault == Fault::broken) details["time_s"] = times.time + times.dt;
  details["dt_s"] = times.dt;
  details["wave_speed_m_per_s"] = c;
  add_particle<dim>(*m_particles, view, p, details);
  details["neighbours"] = neighbours<dim>(view, *m_grid, p);
  return details.dump();  // NaN becomes null
}

#define MPM_INSTANTIATE(dim)                                                                     \
  template void Simulation<dim>::stop_at(int, Simulation<dim>::Fault, const StepTimes&) const;   \
  template std::string Simulation<dim>::describe(int, Simulation<dim>::Fault, const StepTimes&)  \
      const;                                                                                     \
  template Simulation<dim>::Diagnosis Simulation<dim>::diagnose(int, Simulation<dim>::Fault,     \
                                                                double, const StepTimes&) const; \
  template double Simulation<dim>::wave_speed_of(int) const
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::solver
