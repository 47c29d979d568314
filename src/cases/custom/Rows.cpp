#include "Rows.hpp"

#include <fmt/format.h>

namespace mpm::cases::custom {
namespace {

constexpr const char* axes = "xyz";

template <int dim>
void append_force_columns(std::vector<std::string>& columns, const std::string& name) {
  for (int d = 0; d < dim; ++d)
    columns.push_back(fmt::format("{}force_{}_{}", name, axes[d], force_unit<dim>));
  if (dim == 2) columns.push_back(name + "moment_N_m_per_m");
}

template <int dim>
void append_watched_columns(std::vector<std::string>& columns, std::size_t number) {
  const std::string name = fmt::format("watch{}", number);
  for (int d = 0; d < dim; ++d) columns.push_back(fmt::format("{}_{}_m", name, axes[d]));
  for (int d = 0; d < dim; ++d)
    columns.push_back(fmt::format("{}_displacement_{}_m", name, axes[d]));
  for (const char* what : {"q_Pa", "p_Pa", "volumetric_strain", "deviatoric_strain"})
    columns.push_back(fmt::format("{}_{}", name, what));
}

template <int dim>
void append_watched(std::vector<double>& row, const run::Watched<dim>& seen) {
  row.insert(row.end(), seen.position.begin(), seen.position.end());
  row.insert(row.end(), seen.displacement.begin(), seen.displacement.end());
  row.insert(row.end(), {seen.q, seen.p, seen.volumetric_strain, seen.deviatoric_strain});
}

}  // namespace

template <int dim>
Rows<dim>::Rows(const std::vector<Body<dim>>& bodies, const std::vector<Vector<dim>>& watched)
    : m_bodies(bodies) {
  for (const Body<dim>& body : bodies)
    m_reactions.push_back(std::make_shared<run::BodyReaction<dim>>(body.rigid, body.contour));
  for (const Vector<dim>& point : watched)
    m_watched.push_back(std::make_shared<run::WatchedParticle<dim>>(point));
}

template <int dim>
std::vector<std::shared_ptr<run::Observer<dim>>> Rows<dim>::observers() const {
  std::vector<std::shared_ptr<run::Observer<dim>>> all(m_reactions.begin(), m_reactions.end());
  all.insert(all.end(), m_watched.begin(), m_watched.end());
  return all;
}

template <int dim>
std::vector<std::string> Rows<dim>::body_columns(const std::string& name) {
  std::vector<std::string> columns;
  for (int d = 0; d < dim; ++d) columns.push_back(fmt::format("{}_{}_m", name, axes[d]));
  if (dim == 2) columns.push_back(name + "_angle_rad");
  append_force_columns<dim>(columns, name + "_");
  append_force_columns<dim>(columns, name + "_contour_");
  return columns;
}

template <int dim>
std::vector<std::string> Rows<dim>::columns() const {
  std::vector<std::string> columns{"time_s", "stage"};
  for (const Body<dim>& body : m_bodies)
    for (std::string& column : body_columns(body.name)) columns.push_back(std::move(column));
  for (std::size_t k = 0; k < m_watched.size(); ++k) append_watched_columns<dim>(columns, k + 1);
  return columns;
}

template <int dim>
void Rows<dim>::append_force(std::vector<double>& row, const contact::BodyForce<dim>& force) {
  row.insert(row.end(), force.force.begin(), force.force.end());
  if (dim == 2) row.push_back(force.moment);
}

template <int dim>
void Rows<dim>::append_body(std::vector<double>& row, std::size_t k,
                            const petsc::Communicator& ranks) {
  const contact::RigidBody<dim>& body = *m_bodies[k].rigid;
  row.insert(row.end(), body.position.begin(), body.position.end());
  if (dim == 2) row.push_back(body.angle);
  append_force(row, m_reactions[k]->take_by_impulse(ranks));
  append_force(row, m_reactions[k]->take_by_contour(ranks));
}

template <int dim>
std::vector<double> Rows<dim>::row(const run::Moment<dim>& now) {
  std::vector<double> row{now.clock.time, static_cast<double>(now.clock.stage)};
  for (std::size_t k = 0; k < m_bodies.size(); ++k)
    append_body(row, k, now.simulation.communicator());
  for (const auto& particle : m_watched)
    append_watched<dim>(row, particle->observe(now.simulation.particles()));
  return row;
}

template class Rows<1>;
template class Rows<2>;
template class Rows<3>;

}  // namespace mpm::cases::custom
