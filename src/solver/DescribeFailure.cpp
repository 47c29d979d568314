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
std::string Simulation<dim>::describe(int p, Fault fault, const StepTimes& times) const {
  const double c = wave_speed_of(p);  // before the columns are open here
  const particles::ParticleView<dim> view = m_particles->view();
  const Vector<dim> x = view.position_of(p), v = view.velocity_of(p);
  const double speed = length<dim>(v);
  std::string kind, what, remedy;
  if (fault == Fault::collapsed_step) {
    kind = "time_step_collapsed";
    what = fmt::format("lets the time step collapse to {:.3g} s, the first was {:.3g} s,", times.dt,
                       m_first_dt);
    remedy = "a smaller -courant, or a law that does not stiffen without bounds";
  } else if (fault == Fault::runaway) {
    kind = "runaway_velocity";
    what = fmt::format("moves with {:.3g} m/s, far faster than its waves of {:.3g} m/s,", speed, c);
    remedy = "a smaller -courant, or a slower motion";
  } else if (!is_finite<dim>(x) || !is_finite<dim>(v)) {
    kind = "not_a_number";
    what = "lost its position";
    remedy = "a smaller -courant";
  } else if (!m_grid->all_cells().contains(m_grid->cell_of(x))) {
    kind = "particle_lost";
    what = "left the grid or lost its position";
    remedy = "a larger domain or a slower motion; a smaller -courant where the run is unstable";
  } else {
    kind = "law_cannot_follow";
    what = "has a stress that is not a number";
    remedy = "a smaller -courant or a slower motion, so that a step strains less";
  }
  if (m_courant > m_largest_courant)
    remedy = fmt::format(
        "a smaller -courant: it is {:.4g}, and {:.3g} is the largest at which this basis, update "
        "and transfer are stable",
        m_courant, m_largest_courant);
  nlohmann::ordered_json details;
  details["kind"] = kind;
  details["message"] = fmt::format("particle {} {} in step {}, x = ({:.6g}); what may help: {}",
                                   view.id[p], what, m_steps + 1, fmt::join(x, ", "), remedy);
  details["try"] = remedy;
  details["step"] = m_steps + 1;
  details["last_good_step"] = m_steps;
  if (fault == Fault::broken) details["time_s"] = times.time + times.dt;
  details["dt_s"] = times.dt;
  details["particle"] = view.id[p];
  details["position_m"] = to_json<dim>(x);
  details["velocity_m_per_s"] = to_json<dim>(v);
  details["wave_speed_m_per_s"] = c;
  details["volume_m3"] = view.volume[p];
  for (int k = 0; k < tensor_components<dim>; ++k)
    details["stress_Pa"].push_back(view.stress[k][p]);
  const auto material = static_cast<int>(view.material[p]);
  details["material"] = material;
  const auto& law = *m_particles->materials()[static_cast<std::size_t>(material)];
  for (const auto& variable : law.state_variables())
    details["state"][variable.name] = view[m_particles->state(material, variable.name)][p];
  details["neighbours"] = neighbours<dim>(view, *m_grid, p);
  return details.dump();  // NaN becomes null
}

#define MPM_INSTANTIATE(dim)                                                                    \
  template void Simulation<dim>::stop_at(int, Simulation<dim>::Fault, const StepTimes&) const;  \
  template std::string Simulation<dim>::describe(int, Simulation<dim>::Fault, const StepTimes&) \
      const;                                                                                    \
  template double Simulation<dim>::wave_speed_of(int) const
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::solver
