#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <utility>

#include "mpm/contact/RigidBody.hpp"
#include "mpm/run/Stage.hpp"

namespace mpm::run {

/// After so much time of the stage, s; met exactly.
template <int dim>
class AfterTime : public Ending<dim> {
 public:
  explicit AfterTime(double duration) : m_duration(duration) {}
  double share_done(const Moment<dim>& moment) const override {
    return moment.clock.time_in_stage / m_duration + 1e-12;
  }
  double time_left(const Clock& clock) const override { return m_duration - clock.time_in_stage; }

 private:
  double m_duration;
};

template <int dim>
class AfterSteps : public Ending<dim> {
 public:
  explicit AfterSteps(long long steps) : m_steps(static_cast<double>(steps)) {}
  double share_done(const Moment<dim>& moment) const override {
    return static_cast<double>(moment.clock.steps_in_stage) / m_steps;
  }

 private:
  double m_steps;
};

/// When a function of the run has come to 1.
template <int dim>
class When : public Ending<dim> {
 public:
  using Share = std::function<double(const Moment<dim>&)>;
  explicit When(Share share) : m_share(std::move(share)) {}
  double share_done(const Moment<dim>& moment) const override { return m_share(moment); }

 private:
  Share m_share;
};

/// When a rigid body is so far from where it was when the stage began, m.
template <int dim>
class AfterWay : public Ending<dim> {
 public:
  AfterWay(std::shared_ptr<const contact::RigidBody<dim>> body, double distance)
      : m_body(std::move(body)), m_distance(distance) {}

  void begin(const Moment<dim>&) override { m_start = m_body->position; }
  double share_done(const Moment<dim>&) const override {
    double square = 0.0;
    for (int d = 0; d < dim; ++d)
      square += (m_body->position[d] - m_start[d]) * (m_body->position[d] - m_start[d]);
    return std::sqrt(square) / m_distance + 1e-9;
  }
  void persist(Archive& archive) override { archive("start", m_start); }

 private:
  std::shared_ptr<const contact::RigidBody<dim>> m_body;
  double m_distance;
  Vector<dim> m_start{};
};

/// How a body comes to rest under local damping.
template <int dim>
struct RestOptions {
  double tolerance = 1e-3;      ///< the end: sum |f| as a share of the reference force
  double reference_force = 0;   ///< N; 0 stands for the weight
  long long longest = 200'000;  ///< steps, after which the run fails
  long long check_every = 50;   ///< steps
  /// Called at every check.
  std::function<void(const Moment<dim>&)> at_check = {};
};

/// When the forces on the nodes, damping apart, are small. Throws NumericalFailure after the
/// longest time.
template <int dim>
class AtRest : public Ending<dim> {
 public:
  explicit AtRest(RestOptions<dim> options) : m_options(std::move(options)) {}

  void begin(const Moment<dim>&) override { m_unbalanced = 1.0; }
  void after_step(const Moment<dim>& moment) override;
  double share_done(const Moment<dim>&) const override;
  std::string status() const override;
  void persist(Archive& archive) override { archive("unbalanced", m_unbalanced); }

  /// The share at the last check, at most 1.
  double unbalanced() const { return m_unbalanced; }

 private:
  RestOptions<dim> m_options;
  double m_unbalanced = 1.0;
};

/// sum |f| of the nodes without damping as a share of a force, 0 standing for the weight; at most
/// 1. Collective.
template <int dim>
double unbalanced_share(const solver::Simulation<dim>& simulation, double reference_force);

}  // namespace mpm::run
