#include "mpm/cases/PipeEvidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mpm/cases/Evidence.hpp"
#include "mpm/cases/ReactionAgreement.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::cases {
namespace {

constexpr double depth_in_pipe = 0.02;  // of its radius, from which on a particle is in it
constexpr double strip_width = 0.5;     // D, along a wall
constexpr double shortest_curve = 0.1;  // u/D, with an answer that could be contradicted
constexpr double first_place = 0.05;    // u/D; before it reactions are small and waves are not

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double largest(const std::vector<double>& values) {
  return *std::ranges::max_element(values);
}

double last(const std::vector<double>& values) {
  return values.back();
}

}  // namespace

std::vector<run::Check> pipe_checks() {
  return {
      {.name = "reactions",
       .limits = {0.05, 0.2},
       .sentence = "rms difference of the reactions by contact and by the momentum of the soil "
                   "around the pipe",
       .remedy = "a slower push, a larger domain or more cells may help"},
      {.name = "energy",
       .limits = {0.15, 0.4},
       .sentence = "energy lost in transfers between particles and grid over the work of the pipe",
       .remedy = "a longer -flip_time or a slower push may help"},
      {.name = "inertia",
       .limits = {0.1, 0.5},
       .sentence = "mean kinetic energy over the work of the reaction on D/400, about what inertia "
                   "adds to N_d",
       .remedy = "a smaller -inertia_tolerance or -pipe_velocity helps"},
      {.name = "particles_in_pipe",
       .limits = {0.0, 0.01},
       .sentence = "area of the particles deeper in the pipe than 2 % of its radius over that of "
                   "the pipe",
       .remedy = "-contact_detection spring or a slower push helps"},
      {.name = "side_wall",
       .limits = {0.03, 0.04},
       .sentence = "largest deviatoric strain beside the side wall, which bands must not reach",
       .remedy = "a larger -pipe_domain_width helps"},
      {.name = "bottom",
       .limits = {0.12, 0.25},
       .sentence = "mean rise of the pressure on the bottom below the pipe over reaction/D, about "
                   "half of what the bottom adds to N_d at u/D = 0.05",
       .remedy = "a larger -pipe_domain_depth_below helps"},
      limits_of_law()};
}

std::vector<std::string> PipeEvidence::columns() {
  return {"particles_at_limits", "particles_in_pipe", "strain_at_side", "bottom_pressure_share",
          "energy_residual_share"};
}

std::vector<double> PipeEvidence::row(const run::Moment<2>& now, const contact::RigidBody<2>& body,
                                      double reaction) const {
  // One look at the particles at a time: the swarm lends its columns once.
  const double residual = energy_residual_share(now.simulation.ledger());
  const double at_limits = particles_at_limits(now.simulation.particles());
  const double inside =
      particles_inside(now.simulation.particles(), body, depth_in_pipe * m_pipe.radius());
  const auto view = now.simulation.particles().view();
  return {at_limits, inside, strain_at_side(view),
          rise_at_bottom(view) * m_pipe.diameter / reaction, residual};
}

/// Not thinner than the widest cells.
double PipeEvidence::strip() const {
  return std::max(strip_width * m_pipe.diameter, m_pipe.far_cell_ratio * m_pipe.cell());
}

double PipeEvidence::strain_at_side(const particles::ParticleView<2>& view) const {
  const double begin = m_pipe.domain_width * m_pipe.diameter - strip();
  double strain = 0.0;
  for (int p = 0; p < view.count; ++p)
    if (std::abs(view.position[0][p]) > begin) strain = std::max(strain, view.deviatoric_strain[p]);
  return petsc::maximum(strain);
}

/// Mean over the pipe's width of the vertical pressure beyond the weight of the soil, Pa.
double PipeEvidence::rise_at_bottom(const particles::ParticleView<2>& view) const {
  const double bottom =
      -(m_pipe.depth() + m_pipe.radius() + m_pipe.domain_depth_below * m_pipe.diameter);
  std::vector<double> rise_and_count{0.0, 0.0};
  for (int p = 0; p < view.count; ++p) {
    const double x = view.position[0][p], y = view.position[1][p];
    if (std::abs(x) > m_pipe.radius() || y > bottom + strip()) continue;
    rise_and_count[0] += -view.stress[1][p] + m_pipe.unit_weight() * y;
    rise_and_count[1] += 1.0;
  }
  petsc::world().sum(rise_and_count);
  return rise_and_count[0] / rise_and_count[1];
}

namespace {

/// Holds columns of a history against checks.
class Holder {
 public:
  Holder(const run::Checks& checks, const run::History<2>& history, std::size_t place,
         double place_of_answer, io::Summary& summary)
      : m_checks(checks),
        m_history(history),
        m_place(place),
        m_place_of_answer(place_of_answer),
        m_summary(summary) {}

  template <class Measure>
  void hold(const char* check, std::size_t column, Measure measure, double factor = 1.0) const {
    const auto end = std::numeric_limits<double>::max();
    m_checks.hold(check,
                  {factor * measure(values(column, m_place_of_answer)),
                   factor * measure(values(column, end))},
                  m_summary);
  }

 private:
  /// From the first place on that is judged, and at least the last one.
  std::vector<double> values(std::size_t column, double last_place) const {
    std::vector<double> all;
    for (const auto& row : m_history.rows())
      if (row[m_place] >= first_place && row[m_place] <= last_place) all.push_back(row[column]);
    if (all.empty()) all.push_back(m_history.last(column));
    return all;
  }

  const run::Checks& m_checks;
  const run::History<2>& m_history;
  std::size_t m_place;
  double m_place_of_answer;
  io::Summary& m_summary;
};

}  // namespace

void hold_evidence(const PipeOptions& pipe, const run::History<2>& history,
                   const PipeColumns& columns, double u_df_over_D, io::Summary& summary) {
  const double end = history.last(columns.u_over_D);
  if (end < shortest_curve) return;
  // Earlier than that there are too few rows to judge by.
  const double answer = std::isnan(u_df_over_D) ? end : std::max(u_df_over_D, shortest_curve);
  const ReactionColumns reactions{columns.u_over_D, columns.N_d, columns.N_d_contour};
  const auto differ = [&](double to) { return compare_reactions(history, reactions, to).rms; };
  pipe.checks.hold("reactions", {differ(answer), differ(end)}, summary);

  const double spacing =
      pipe.cell() / static_cast<double>(
                        std::max(pipe.particles_near_pipe, pipe.run.particles_per_cell_direction));
  const double modelled = pipe.is_half() ? 0.5 : 1.0;
  const double area_share =
      spacing * spacing / (modelled * std::numbers::pi * pipe.radius() * pipe.radius());
  const Holder holder(pipe.checks, history, columns.u_over_D, answer, summary);
  const std::size_t first = columns.first_of_evidence;
  holder.hold("inertia", columns.inertia, mean);
  holder.hold("limits_of_law", first, largest, 1.0 / summary.number("particles"));
  holder.hold("particles_in_pipe", first + 1, largest, area_share);
  holder.hold("side_wall", first + 2, largest);
  holder.hold("bottom", first + 3, mean);
  holder.hold("energy", first + 4, last);
}

}  // namespace mpm::cases
