#pragma once

#include <memory>

#include "mpm/contact/Motion.hpp"
#include "mpm/geometry/Shape.hpp"
#include "mpm/grid/Constraint.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::contact {

/// What acts on a rigid body, as means over time.
template <int dim>
struct BodyForce {
  Vector<dim> force{};  ///< N (per metre in plane strain)
  double moment = 0.0;  ///< N m, anticlockwise about the reference point; 2D only
};

/// r x f where there is one moment, in the plane; 0 elsewhere.
template <int dim>
double moment_of(const Vector<dim>& r, const Vector<dim>& f) {
  if constexpr (dim == 2) return r[0] * f[1] - r[1] * f[0];
  return 0.0;
}

/// Measures what the ground does to a rigid body by the impulses that constraints of the body have
/// booked, over a time of its own.
template <int dim>
class Meter {
 public:
  /// Where the constraints of the body book what they give to nodes.
  grid::Booking<dim>& booking() { return m_booking; }
  /// The moment of an impulse given to a node at r from the reference point.
  void add_moment(const Vector<dim>& r, const Vector<dim>& impulse) {
    if constexpr (dim == 2) m_moment_given += moment_of<dim>(r, impulse);
  }
  /// Called after every step with the time over which its forces have acted, s.
  void advance(double momentum_dt) { m_time += momentum_dt; }

  /// Mean since the last call; 0 if no time has gone. Collective.
  BodyForce<dim> take_mean(const petsc::Communicator& ranks = petsc::world()) {
    BodyForce<dim> mean;
    const Vector<dim> given = m_booking.take_impulse();
    for (int d = 0; d < dim; ++d) mean.force[d] = mean_of(given[d], ranks);
    mean.moment = mean_of(m_moment_given, ranks);
    forget();
    return mean;
  }

  /// Impulse of the ground on the body since the last call, N s, this rank's share.
  Vector<dim> take_impulse() {
    Vector<dim> impulse = m_booking.take_impulse();
    for (double& component : impulse) component = 0.0 - component;
    forget();
    return impulse;
  }

  void forget() {
    m_booking.take_impulse();
    m_moment_given = m_time = 0.0;
  }

  void persist(Archive& archive) {
    m_booking.persist(archive);
    archive.sum("moment_given", m_moment_given);
    archive("time", m_time);
  }

 private:
  double mean_of(double given, const petsc::Communicator& ranks) const {
    const double sum = ranks.sum(0.0 - given);
    return m_time > 0.0 ? sum / m_time : 0.0;
  }

  grid::Booking<dim> m_booking;
  double m_moment_given = 0.0;  ///< N m s, to nodes
  double m_time = 0.0;          ///< s
};

/// A body without stress that moves as its motion says, whatever the ground does.
template <int dim>
class RigidBody {
 public:
  /// Stands still where there is no motion. `shape` is about the reference point.
  explicit RigidBody(std::shared_ptr<const geometry::Shape<dim>> shape, const Vector<dim>& at = {},
                     std::shared_ptr<const Motion<dim>> motion = nullptr)
      : position(at), m_shape(std::move(shape)), m_motion(std::move(motion)) {}

  Vector<dim> position;    ///< of the reference point, m
  double angle = 0.0;      ///< turned since the start, rad; 2D only
  Vector<dim> velocity{};  ///< m/s
  double spin = 0.0;       ///< rad/s

  /// Takes the velocity of the motion in the middle of a step.
  void begin_step(double dt) {
    m_is_free = true;
    if (!m_motion) return;
    const BodyVelocity<dim> now = m_motion->at(m_time + 0.5 * dt);
    velocity = now.translation;
    spin = now.spin;
  }
  /// Moves by the step.
  void end_step(double dt, double momentum_dt) {
    for (int d = 0; d < dim; ++d) position[d] += velocity[d] * dt;
    angle += spin * dt;
    if (m_is_free) m_time += dt;
    m_meter.advance(momentum_dt);
  }
  /// In place of begin_step: the time of the motion stops too.
  void stand_still() {
    m_is_free = false;
    velocity = {};
    spin = 0.0;
  }

  /// Where x lies relative to the surface.
  geometry::Proximity<dim> locate(const Vector<dim>& x) const {
    Vector<dim> r = from_reference(x);
    if (angle == 0.0) return m_shape->locate(r);
    geometry::Proximity<dim> turned = m_shape->locate(rotated(r, -angle));
    turned.normal = rotated(turned.normal, angle);
    return turned;
  }
  /// x from the reference point, turned back with the body.
  Vector<dim> in_body_frame(const Vector<dim>& x) const {
    return rotated(from_reference(x), -angle);
  }
  /// A difference of two places in the body's frame, as it lies in space.
  Vector<dim> turned_to_space(const Vector<dim>& difference) const {
    return rotated(difference, angle);
  }
  /// Of a place in the body's frame from the surface, m.
  double distance_in_body_frame(const Vector<dim>& place) const {
    return m_shape->locate(place).distance;
  }
  Vector<dim> from_reference(const Vector<dim>& x) const {
    Vector<dim> r;
    for (int d = 0; d < dim; ++d) r[d] = x[d] - position[d];
    return r;
  }
  /// Of the body's point at r from its reference point.
  Vector<dim> velocity_at(const Vector<dim>& r) const {
    Vector<dim> v = velocity;
    if constexpr (dim == 2)
      if (spin != 0.0) v = {v[0] - spin * r[1], v[1] + spin * r[0]};
    return v;
  }

  Meter<dim>& meter() { return m_meter; }

  void persist(Archive& archive) {
    archive("position", position);
    archive("angle", angle);
    archive("velocity", velocity);
    archive("spin", spin);
    archive("time", m_time);
    archive("is_free", m_is_free);
    archive.group("meter", [&] { m_meter.persist(archive); });
  }

 private:
  static Vector<dim> rotated(Vector<dim> r, double by) {
    if constexpr (dim == 2) {
      const double c = std::cos(by), s = std::sin(by);
      r = {c * r[0] - s * r[1], s * r[0] + c * r[1]};
    }
    return r;
  }

  std::shared_ptr<const geometry::Shape<dim>> m_shape;
  std::shared_ptr<const Motion<dim>> m_motion;
  double m_time = 0.0;  ///< s, while it was not held
  bool m_is_free = false;
  Meter<dim> m_meter;
};

}  // namespace mpm::contact
