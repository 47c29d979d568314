#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "mpm/core/Archive.hpp"
#include "mpm/grid/Grid.hpp"

namespace mpm::grid {

/// What a constraint has given to nodes. All of it is this rank's share.
template <int dim>
struct Booking {
  struct Change {
    int node;              ///< local
    Vector<dim> momentum;  ///< given to it, N s
  };

  /// Given to nodes in momentum updates since it was last taken, N s (per metre in plane strain).
  Vector<dim> impulse{};
  /// Of the last momentum update, in the order given; a node may occur several times.
  std::vector<Change> changes;
  /// Sum over them of the momentum times the velocity that the constraint itself has there, J.
  double work = 0.0;

  void begin_momentum_update() {
    changes.clear();
    work = 0.0;
  }

  Vector<dim> take_impulse() { return std::exchange(impulse, Vector<dim>{}); }
  bool has_acted_on(int node) const {
    return std::ranges::find(changes, node, &Change::node) != changes.end();
  }
  void persist(Archive& archive) { archive.sum("impulse", impulse); }
};

/// The nodes of a rank in one of the two mappings of a step, as constraints may change them: the
/// one place where that is done and booked. In the momentum update (Eq. 6) a change of momentum is
/// one of the force too, and is booked; the mapping of Eq. 9 gives particles no impulse.
template <int dim>
class ConstrainedNodes {
 public:
  /// Of the momentum update, in which forces act over dt, s.
  ConstrainedNodes(const double* mass, const std::array<double*, dim>& momentum,
                   const std::array<double*, dim>& force, double dt)
      : m_mass(mass), m_momentum(momentum), m_force(force), m_dt(dt) {}
  /// Of the mapping of Eq. 9.
  ConstrainedNodes(const double* mass, const std::array<double*, dim>& momentum)
      : m_mass(mass), m_momentum(momentum) {}

  /// Changes are booked there from here on.
  void book_on(Booking<dim>& booking) {
    m_booking = &booking;
    if (is_momentum_update()) booking.begin_momentum_update();
  }

  bool is_momentum_update() const { return m_force[0] != nullptr; }
  /// Time over which the force changes the momentum, s; 0 in the mapping of Eq. 9.
  double dt() const { return m_dt; }
  double mass(int I) const { return m_mass[I]; }
  double momentum(int I, int d) const { return m_momentum[d][I]; }

  /// Gives a node the constraint's v as component d of its velocity, m/s. Returns the momentum
  /// given, N s.
  double set_velocity(int I, int d, double v) {
    const double change = m_mass[I] * v - m_momentum[d][I];
    m_momentum[d][I] += change;
    if (!is_momentum_update()) return change;
    m_force[d][I] += change / m_dt;
    m_booking->impulse[d] += change;
    m_booking->work += change * v;
    Vector<dim> given{};
    given[d] = change;
    m_booking->changes.push_back({I, given});
    return change;
  }

  /// Changes the velocity of a node where the constraint itself has the velocity `own`, m/s.
  void change_velocity(int I, const Vector<dim>& change, const Vector<dim>& own = {}) {
    Vector<dim> given;
    for (int d = 0; d < dim; ++d) given[d] = m_mass[I] * change[d];
    add_momentum(I, given, own);
  }

  /// Gives a node momentum, N s, where the constraint itself has the velocity `own`, m/s.
  void add_momentum(int I, const Vector<dim>& given, const Vector<dim>& own = {}) {
    for (int d = 0; d < dim; ++d) m_momentum[d][I] += given[d];
    if (!is_momentum_update()) return;
    for (int d = 0; d < dim; ++d) {
      m_force[d][I] += given[d] / m_dt;
      m_booking->impulse[d] += given[d];
      m_booking->work += given[d] * own[d];
    }
    m_booking->changes.push_back({I, given});
  }

 private:
  const double* m_mass;
  std::array<double*, dim> m_momentum, m_force{};
  double m_dt = 0.0;
  Booking<dim>* m_booking = nullptr;
};

/// Something that asks nodes for a motion: a rigid body, a prescribed velocity.
template <int dim>
class Constraint {
 public:
  virtual ~Constraint() = default;
  /// Called before every step of dt, while particles may be looked at. Local.
  virtual void look_at_particles(double /*dt*/) {}
  /// Called when the nodal masses are known, before nodes are constrained: once in a step, and once
  /// more with -update usf, which has two depositions. Collective.
  virtual void find_nodes() {}
  /// Asks owned nodes for what has to hold, in both mappings of a step. Local.
  virtual void constrain(const Grid<dim>& grid, ConstrainedNodes<dim>& nodes) = 0;
  /// Whether nodes it has acted on are left out of local damping, which would show in its force.
  virtual bool spares_from_damping() const { return false; }
  /// The cause that its impulses and its work are booked under.
  virtual std::string label() const { return "constraint"; }
  virtual Booking<dim>& booking() { return m_booking; }
  /// Saves or puts back what it knows between steps.
  virtual void persist(Archive& archive) { booking().persist(archive); }

 private:
  Booking<dim> m_booking;
};

}  // namespace mpm::grid
