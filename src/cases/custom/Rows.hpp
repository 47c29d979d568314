#pragma once

#include <memory>
#include <string>
#include <vector>

#include "Bodies.hpp"
#include "mpm/run/BodyReaction.hpp"
#include "mpm/run/WatchedParticle.hpp"

namespace mpm::cases::custom {

/// What history.csv holds: time and stage, then for each body where it is and what the ground does
/// to it by impulse and by contour, then each watched particle. Forces are means since the row
/// before.
template <int dim>
class Rows {
 public:
  Rows(const std::vector<Body<dim>>& bodies, const std::vector<Vector<dim>>& watched);

  /// To be run before the history.
  std::vector<std::shared_ptr<run::Observer<dim>>> observers() const;
  std::vector<std::string> columns() const;
  /// Columns of time and stage, which come first.
  static constexpr std::size_t of_time = 2;
  /// Collective.
  std::vector<double> row(const run::Moment<dim>& now);

  /// Where the values of body k begin and how many it has; the order is that of body_columns().
  std::size_t first_of(std::size_t body) const { return of_time + body * body_columns("").size(); }
  /// Where the force by impulse is among the values of a body.
  static constexpr std::size_t force = dim == 2 ? dim + 1 : dim;
  static std::vector<std::string> body_columns(const std::string& name);

 private:
  void append_body(std::vector<double>& row, std::size_t k, const petsc::Communicator& ranks);
  static void append_force(std::vector<double>& row, const contact::BodyForce<dim>& force);

  std::vector<Body<dim>> m_bodies;
  std::vector<std::shared_ptr<run::BodyReaction<dim>>> m_reactions;
  std::vector<std::shared_ptr<run::WatchedParticle<dim>>> m_watched;
};

/// The unit of a force as names of columns write it.
template <int dim>
inline constexpr const char* force_unit = dim == 1 ? "N_per_m2" : (dim == 2 ? "N_per_m" : "N");

extern template class Rows<1>;
extern template class Rows<2>;
extern template class Rows<3>;

}  // namespace mpm::cases::custom
