#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/io/Summary.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/material/SandLaw.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/RunOptions.hpp"

namespace mpm::cases::reversal {

using material::SandInvariants;
using material::SandLaw;

inline constexpr int the_sand = 0;   // the only material
inline constexpr double side = 0.1;  // m, of the cube
inline constexpr int margin = 4;     // empty cells on every side: more than a spline reaches
inline constexpr double room_strain = 4e-3;   // xy, makes room for a loop inside the surface
inline constexpr double loop_stress = 0.25;   // q of the loop as a share of p
inline constexpr double loop_pressure = 0.7;  // p of its lower leg as a share of the upper
inline constexpr double longest_leg = 0.5;    // strain after which a leg has failed to meet its end
inline constexpr long long default_rows = 20;  // steps between rows of history.csv
inline constexpr double floor_margin = 1e-9;   // share of the pressure floor
inline const double root_of_3 = std::sqrt(3.0);

/// A homogeneous motion about the origin; it spins about z only.
struct MotionRate {
  SymmetricTensor D;  ///< 1/s, tension positive
  double spin = 0.0;  ///< (dv_y/dx - dv_x/dy)/2, 1/s

  Vector<3> velocity(const Vector<3>& x) const {
    return {D[0] * x[0] + (D[3] - spin) * x[1], (D[3] + spin) * x[0] + D[1] * x[1], D[2] * x[2]};
  }
};

/// Gives all nodes the velocity of a homogeneous motion.
class PrescribedMotion : public grid::Constraint<3> {
 public:
  MotionRate next;  ///< for the velocities of the step to come

  void constrain(const grid::Grid<3>& grid, grid::ConstrainedNodes<3>& nodes) override {
    // A mapping before the first one of a step (USF) is one of velocities of the step before.
    if (nodes.is_momentum_update()) m_present = next;
    grid.for_each_owned_node([&](int I, const auto& node) {
      const Vector<3> v = m_present.velocity(grid.position(node));
      for (int d = 0; d < 3; ++d) nodes.set_velocity(I, d, v[static_cast<std::size_t>(d)]);
    });
  }

  void persist(Archive& archive) override {
    grid::Constraint<3>::persist(archive);
    for (auto* rate : {&next, &m_present})
      archive.group(rate == &next ? "next" : "present", [&] {
        archive("D", rate->D.components);
        archive("spin", rate->spin);
      });
  }

 private:
  MotionRate m_present;
};

struct ReversalOptions {
  run::RunOptions run;
  material::SandFactory sand;
  std::int64_t cells = 1;  ///< per side
  std::int64_t cycles = 4;
  double pressure = 100e3;    ///< Pa
  double amplitude = 0.01;    ///< shear strain
  double opening = 2e-3;      ///< volume share of the gap
  double strain_rate = 0.02;  ///< 1/s

  ReversalOptions() {
    run.output_dir = "out/reversal";
    sand.parameters().cohesion = 0.0;
    sand.parameters().void_ratio = 0.63;
  }

  void declare(options::OptionSet& options) {
    run.declare(options);
    options.section("Reversal");
    options.integer("cells", cells, {1, 32}, {"1", "cells per side of the cube", "chosen"});
    options.integer("cycles", cycles, {0, 100'000},
                    {"1", "times the cube is sheared, torn, sheared back and closed", "chosen"});
    options.real("confining_pressure", pressure, options::positive(),
                 {"Pa", "mean stress at the start, and to which every cycle returns", "chosen"});
    options.real("amplitude", amplitude, options::positive(),
                 {"1", "shear strain of a cycle", "chosen"});
    options.real("opening", opening, {.minimum = 0.0, .maximum = 0.1, .open_minimum = true},
                 {"1", "volume of the gap that a cycle opens, as a share", "chosen"});
    options.real("strain_rate", strain_rate, options::positive(),
                 {"1/s", "of all legs; steps are as the Courant number has them", "chosen"});
    sand.declare(options);
  }

  solver::SimulationSetup<3> setup() const {
    const auto n = static_cast<int>(cells);
    const double outer = margin * side / n;
    const auto line = basis::KnotLines::uniform(-outer, side + outer, n + 2 * margin);
    solver::SimulationSetup<3> setup{.lines = {line, line, line}};
    run.apply_to(setup);
    for (auto& direction : setup.walls) direction = {grid::Wall::free, grid::Wall::free};
    setup.materials = {sand.create()};
    setup.filling.material_at = [](const Vector<3>& x) {
      const bool inside =
          std::all_of(x.begin(), x.end(), [](double c) { return c > 0.0 && c < side; });
      return inside ? std::optional(the_sand) : std::nullopt;
    };
    return setup;
  }
};

/// The state of the only material.
struct SandState {
  explicit SandState(const particles::Particles<3>& particles)
      : void_ratio(particles.state(the_sand, "void_ratio")),
        eps_q(particles.state(the_sand, "eps_q")),
        gap_volume_ratio(particles.state(the_sand, "gap_volume_ratio")) {}

  particles::StateHandle void_ratio, eps_q, gap_volume_ratio;
};

/// A leg of so much strain and so much rotation about z, at the strain rate of the run.
class Leg : public run::Ending<3> {
 public:
  using Strain = std::function<SymmetricTensor()>;
  Leg(std::shared_ptr<PrescribedMotion> motion, Strain strain, double rotation, double strain_rate)
      : m_motion(std::move(motion)),
        m_strain(std::move(strain)),
        m_rotation(rotation),
        m_strain_rate(strain_rate) {}

  void begin(const run::Moment<3>&) override {
    const SymmetricTensor strain = m_strain();
    m_duration = norm(strain) / m_strain_rate;
    m_motion->next = {(1.0 / m_duration) * strain, m_rotation / m_duration};
  }
  double share_done(const run::Moment<3>& now) const override {
    return now.clock.time_in_stage / m_duration + 1e-12;
  }
  double time_left(const run::Clock& clock) const override {
    return m_duration - clock.time_in_stage;
  }
  void persist(Archive& archive) override { archive("duration", m_duration); }

 private:
  std::shared_ptr<PrescribedMotion> m_motion;
  Strain m_strain;
  double m_rotation, m_strain_rate;
  double m_duration = 0.0;  ///< s
};

/// A leg of the strain rate of the run up to a state.
class OpenLeg : public run::Ending<3> {
 public:
  using IsOver = std::function<bool(const run::Moment<3>&)>;
  OpenLeg(std::shared_ptr<PrescribedMotion> motion, const SymmetricTensor& direction,
          double strain_rate, IsOver is_over)
      : m_motion(std::move(motion)),
        m_direction(direction),
        m_strain_rate(strain_rate),
        m_is_over(std::move(is_over)) {}

  void begin(const run::Moment<3>&) override {
    m_motion->next = {m_strain_rate / norm(m_direction) * m_direction};
  }
  double share_done(const run::Moment<3>& now) const override {
    if (now.clock.steps_in_stage > 0 && m_is_over(now)) return 1.0;
    if (now.clock.time_in_stage * m_strain_rate > longest_leg)
      throw NumericalFailure(
          fmt::format("a leg's strain of {} does not bring the sand there", longest_leg));
    return 0.0;
  }

 private:
  std::shared_ptr<PrescribedMotion> m_motion;
  SymmetricTensor m_direction;
  double m_strain_rate;
  IsOver m_is_over;
};

class Pause : public run::AfterSteps<3> {
 public:
  explicit Pause(std::shared_ptr<PrescribedMotion> motion)
      : run::AfterSteps<3>(2), m_motion(std::move(motion)) {}
  void begin(const run::Moment<3>&) override { m_motion->next = {}; }

 private:
  std::shared_ptr<PrescribedMotion> m_motion;
};

/// Strains of the legs of the elastic loop, known once the cube has been sheared, and its outcome.
class LoopPlan : public run::Observer<3> {
 public:
  double unloading = 0.0, shear = 0.0, swelling = 0.0, shear_back = 0.0;
  double work = 0.0, exact_work = 0.0;  ///< J/m^3
  bool is_closed = false;
  long long cycles_done = 0;

  void persist(Archive& archive) override {
    archive("unloading", unloading);
    archive("shear", shear);
    archive("swelling", swelling);
    archive("shear_back", shear_back);
    archive("work", work);
    archive("exact_work", exact_work);
    archive("is_closed", is_closed);
    archive("cycles_done", cycles_done);
  }
};

/// Means over the particles.
struct Mean {
  double p, q, shear_stress, void_ratio, eps_q, gap;
};

/// Follows every particle through its steps, and the work done on the cube.
class CubeObserver : public run::Observer<3> {
 public:
  CubeObserver(const ReversalOptions& options, std::shared_ptr<PrescribedMotion> motion)
      : m_options(options),
        m_motion(std::move(motion)),
        m_particle_volume(particle_volume(options)) {}

  void begin(const run::Moment<3>& now) override;
  void after_step(const run::Moment<3>& now) override;
  void persist(Archive& archive) override;

  Mean mean(const solver::Simulation<3>& simulation) const;
  double mean_pressure(const solver::Simulation<3>& simulation) const;
  double mean_gap(const solver::Simulation<3>& simulation) const;
  const SandLaw& law() const { return *m_law; }

  void forget_work() { m_work = 0.0; }
  /// Since then, this rank's, J.
  double work() const { return m_work; }
  void report(const petsc::Communicator& ranks, io::Summary& summary) const;

 private:
  struct Before {
    double eps_q;
    SymmetricTensor stress;
  };

  static double particle_volume(const ReversalOptions& options);
  void check(const particles::ParticleView<3>& view, int p, const Before& before);
  void count(double distance_outside, double p_star, bool is_plastic);
  Before state_of(const particles::ParticleView<3>& view, int p) const;
  void persist_particles(Archive& archive);

  const ReversalOptions& m_options;
  std::shared_ptr<PrescribedMotion> m_motion;
  const SandLaw* m_law = nullptr;
  std::optional<SandState> m_sand;
  std::unordered_map<std::int64_t, Before> m_before;  ///< of this rank's particles
  double m_particle_volume;                           ///< m^3, at the start
  SymmetricTensor m_strain;                           ///< of the last step
  SymmetricTensor m_strain_to_come;                   ///< of the step after, with USF
  double m_work = 0.0;                                ///< J, this rank's
  double m_largest_distance = 0.0, m_largest_gap_stress = 0.0, m_largest_volume_error = 0.0;
  double m_largest_gap = 1.0;
  long long m_plastic = 0, m_elastic = 0, m_at_floor = 0;
};

}  // namespace mpm::cases::reversal
