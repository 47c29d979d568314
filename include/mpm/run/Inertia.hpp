#pragma once

#include <memory>
#include <utility>

#include "mpm/contact/PacedMotion.hpp"
#include "mpm/contact/RigidBody.hpp"
#include "mpm/run/Observer.hpp"

namespace mpm::run {

/// How much inertia a push may have, and how quickly its speed follows.
struct InertiaOptions {
  double length;          ///< L, m: the way over which the reaction's work is taken for comparison
  double tolerance;       ///< largest E_k/(F L)
  double smallest_mass;   ///< kg (per metre in plane strain): what moves with the body at the least
  double time;            ///< s, in which the speed follows what is allowed
  double smallest_force;  ///< F at the least, N, so that a body that has lost the ground goes on
};

/// Kinetic energy of the ground as a share of the work of the reaction on a pushed body over a
/// length, E_k/(F L), with F the mean since the last look. Where the motion is paced, its speed
/// follows the largest that keeps the share within the tolerance,
///   v^2 = 2 tolerance F L/M with the moving mass M = 2 E_k/v^2.
template <int dim>
class Inertia : public Observer<dim> {
 public:
  /// `motion` may be null: then the share is measured only.
  Inertia(std::shared_ptr<const contact::RigidBody<dim>> body,
          std::shared_ptr<contact::PacedMotion<dim>> motion, const InertiaOptions& options)
      : m_body(std::move(body)), m_motion(std::move(motion)), m_options(options) {}

  void begin_stage(const Moment<dim>& now) override;
  void after_step(const Moment<dim>& now) override;
  void persist(Archive& archive) override;

  /// At the last look.
  double share() const { return m_share; }

 private:
  void look(const Moment<dim>& now);
  double allowed_speed(double kinetic_energy) const;

  std::shared_ptr<const contact::RigidBody<dim>> m_body;
  std::shared_ptr<contact::PacedMotion<dim>> m_motion;
  InertiaOptions m_options;
  double m_work = 0.0;   ///< J, of the bodies until the last look
  double m_way = 0.0;    ///< m, since the last look
  double m_time = 0.0;   ///< s, since the last look
  double m_force = 0.0;  ///< F at the last look, N
  double m_share = 0.0;
};

}  // namespace mpm::run
