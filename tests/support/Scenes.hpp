#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>

#include "mpm/contact/RigidBody.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/solver/Simulation.hpp"
#include "support/World.hpp"

namespace mpm::test {

inline constexpr material::LinearElasticParameters soft{
    .youngs_modulus = 2.5e3, .poisson_ratio = 0.28, .density = 1300.0};

inline std::shared_ptr<const material::Material> elastic(
    const material::LinearElasticParameters& parameters = soft) {
  return std::make_shared<material::LinearElastic>(parameters);
}

/// Calls check(kind) for every basis, and names the basis where the check fails.
template <class Check>
void for_every_basis(const Check& check) {
  for (const auto& [word, kind] : basis::kinds()) {
    SCOPED_TRACE(word);
    check(kind);
  }
}

template <int dim>
std::array<basis::KnotLines, dim> equal_lines(double begin, double end, int cells) {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<basis::KnotLines, dim>{
        (static_cast<void>(d), basis::KnotLines::uniform(begin, end, cells))...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

/// v_i = L_ij x_j.
template <int dim>
using Gradient = std::array<Vector<dim>, dim>;

template <int dim>
Vector<dim> linear_velocity(const Gradient<dim>& L, const Vector<dim>& x) {
  Vector<dim> v{};
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) v[i] += L[i][j] * x[j];
  return v;
}

/// Gives every node the velocity L x_I.
template <int dim>
class PrescribedGradient : public grid::Constraint<dim> {
 public:
  explicit PrescribedGradient(const Gradient<dim>& L) : m_L(L) {}
  void constrain(const grid::Grid<dim>& grid, grid::ConstrainedNodes<dim>& nodes) override {
    grid.for_each_owned_node([&](int I, const auto& node) {
      const Vector<dim> v = linear_velocity<dim>(m_L, grid.position(node));
      for (int d = 0; d < dim; ++d) nodes.set_velocity(I, d, v[d]);
    });
  }

 private:
  Gradient<dim> m_L;
};

/// A rigid body at a place, with a velocity.
template <int dim, class Shape>
std::shared_ptr<contact::RigidBody<dim>> rigid_body(const Shape& shape, const Vector<dim>& position,
                                                    const Vector<dim>& velocity = {}) {
  auto body = std::make_shared<contact::RigidBody<dim>>(std::make_shared<Shape>(shape), position);
  body->velocity = velocity;
  return body;
}

/// The same kind of wall at both ends of every direction.
template <int dim>
typename grid::Walls<dim>::Kinds walls_all(grid::Wall wall) {
  typename grid::Walls<dim>::Kinds kinds;
  for (auto& direction : kinds) direction = {wall, wall};
  return kinds;
}

/// A simulation that keeps its own time, for tests that drive it step by step.
template <int dim>
class TimedSimulation : public solver::Simulation<dim> {
 public:
  using solver::Simulation<dim>::Simulation;

  /// Advances by a step of at most so many seconds.
  void advance(double limit = std::numeric_limits<double>::max()) {
    times = solver::Simulation<dim>::advance(time(), this->plan(limit));
  }
  /// At the end of the last step, s.
  double time() const { return times.time + times.dt; }

  solver::StepTimes times;  ///< of the last step
};

/// A grid that is full of soft elastic material.
template <int dim>
solver::SimulationSetup<dim> full_box(const std::array<basis::KnotLines, dim>& lines,
                                      grid::Wall wall, int per_direction = 2) {
  solver::SimulationSetup<dim> setup{.lines = lines};
  setup.communicator = world();
  setup.walls = walls_all<dim>(wall);
  setup.materials = {elastic()};
  setup.filling = {[](const auto&) { return 0; },
                   [per_direction](const auto&) { return per_direction; }};
  return setup;
}

/// Sets the velocity of every particle to a function of its position. Local.
template <int dim>
void set_velocity(solver::Simulation<dim>& simulation,
                  const std::function<Vector<dim>(const Vector<dim>&)>& velocity) {
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p) {
    const Vector<dim> v = velocity(view.position_of(p));
    for (int d = 0; d < dim; ++d) view.velocity[d][p] = v[d];
  }
}

/// Advances by steps of dt, or shorter ones where stability asks for them.
template <int dim>
void run_steps(TimedSimulation<dim>& simulation, int steps, double dt) {
  for (int k = 0; k < steps; ++k) simulation.advance(dt);
}

template <int dim>
void set_stress(solver::Simulation<dim>& simulation, const SymmetricTensor& stress) {
  const auto view = simulation.particles().view();
  for (int p = 0; p < view.count; ++p)
    for (int k = 0; k < tensor_components<dim>; ++k) view.stress[k][p] = stress[k];
}

}  // namespace mpm::test
