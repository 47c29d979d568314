#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_map>

#include "mpm/core/Errors.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/material/SandLaw.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/run/InitialStress.hpp"
#include "mpm/scene/RunLoop.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

using material::SandInvariants;
using material::SandLaw;

constexpr int the_sand = 0;             // the only material
constexpr double side = 0.1;            // m, of the cube
constexpr int margin = 4;               // empty cells on every side: more than a spline reaches
constexpr double room_strain = 4e-3;    // xy, makes room for a loop inside the surface
constexpr double loop_stress = 0.25;    // q of the loop as a share of p
constexpr double loop_pressure = 0.7;   // p of its lower leg as a share of the upper
constexpr double longest_leg = 0.5;     // strain after which a leg has failed to meet its end
constexpr long long default_rows = 20;  // steps between rows of history.csv
constexpr double floor_margin = 1e-9;   // share of the pressure floor
const double root_of_3 = std::sqrt(3.0);

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
    setup.filling = {
        [](const Vector<3>& x) {
          const bool inside =
              std::all_of(x.begin(), x.end(), [](double c) { return c > 0.0 && c < side; });
          return inside ? std::optional(the_sand) : std::nullopt;
        },
        [this](const auto&) { return static_cast<int>(run.particles_per_cell_direction); }};
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

/// A cube of sand that is moved homogeneously by its nodes. First a closed loop of isotropic
/// pressure and shear inside the loading surface: G depends on p, so it does the work
/// (q^2/6)(1/G1 - 1/G2) per volume. Then cycles: sheared, torn until a gap opens, sheared back
/// while open, closed and pressed together again. The state has to stay on the loading surface
/// while eps_q grows and never lie outside it; an open gap carries what its opening leaves of the
/// cohesion. Three dimensions, since plane strain knows no isotropic swelling.
class ReversalRun {
 public:
  ReversalRun(const ReversalOptions& options, io::Summary& summary);
  void run();

 private:
  struct Before {
    double eps_q;
    SymmetricTensor stress;
  };
  struct Mean {
    double p, q, shear_stress, void_ratio, eps_q, gap;
  };

  bool make_loop();
  bool cycle();
  bool move(const std::string& name, const SymmetricTensor& strain, double spin = 0.0);
  bool move_until(const std::string& name, const SymmetricTensor& direction,
                  const std::function<bool()>& is_over);
  bool rest();
  bool follow(Stage stage, const MotionRate& rate);
  void after_step();
  void check(const particles::ParticleView<3>& view, int p, const Before& before);
  Before state_of(const particles::ParticleView<3>& view, int p) const;
  Mean mean() const;
  double mean_pressure() const;
  double mean_gap() const;
  void write_row();
  void conclude();

  const ReversalOptions& m_options;
  io::Summary& m_summary;
  solver::Simulation<3> m_simulation;
  const SandLaw& m_law;
  SandState m_sand;
  std::shared_ptr<PrescribedMotion> m_motion;
  RunLoop<3> m_loop;
  io::CsvFile m_history;
  std::unordered_map<std::int64_t, Before> m_before;  ///< of this rank's particles
  double m_particle_volume;                           ///< m^3, at the start
  SymmetricTensor m_strain;                           ///< of the last step
  SymmetricTensor m_strain_to_come;                   ///< of the step after, with USF
  double m_work = 0.0;                                ///< J, this rank's
  double m_largest_distance = 0.0, m_largest_gap_stress = 0.0, m_largest_volume_error = 0.0;
  double m_largest_gap = 1.0;
  long long m_plastic = 0, m_elastic = 0, m_at_floor = 0, m_cycles_done = 0;
};

double initial_particle_volume(const ReversalOptions& options) {
  return std::pow(
      side / static_cast<double>(options.cells * options.run.particles_per_cell_direction), 3);
}

ReversalRun::ReversalRun(const ReversalOptions& options, io::Summary& summary)
    : m_options(options),
      m_summary(summary),
      m_simulation(options.setup()),
      m_law(dynamic_cast<const SandLaw&>(*m_simulation.particles().materials()[the_sand])),
      m_sand(m_simulation.particles()),
      m_motion(std::make_shared<PrescribedMotion>()),
      m_loop(options.run, m_simulation),
      m_history(options.run.output_dir + "/history.csv",
                {"time_s", "p_Pa", "q_Pa", "shear_stress_Pa", "void_ratio", "eps_q",
                 "gap_volume_ratio", "dt_s", "step", "stage"}),
      m_particle_volume(initial_particle_volume(options)) {
  run::prescribe_pressure(m_simulation, options.pressure);
  m_simulation.add_constraint(m_motion);
}

void ReversalRun::run() {
  write_row();
  bool goes_on = make_loop();
  while (goes_on && m_cycles_done < m_options.cycles) goes_on = cycle();
  m_loop.write_fields();
  m_loop.summarise(m_summary);
  conclude();
}

/// Pure shear at p1, swelling to p2, shear back, compression to p1: every leg elastic.
bool ReversalRun::make_loop() {
  const SymmetricTensor shear{{0, 0, 0, 1, 0, 0}}, swelling{{1, 1, 1, 0, 0, 0}};
  if (!move("room for a loop", room_strain * shear) || !rest()) return false;
  const material::SandElasticity& elasticity = m_law.surface().elasticity();
  // Without cohesion's shift, which p* holds and p does not.
  const double shift = m_law.invariants({}).p_star;
  const Mean sheared = mean();
  const double p1 = sheared.p + shift, p2 = loop_pressure * p1, q = loop_stress * p1;
  const double G1 = elasticity.shear_modulus(p1), G2 = elasticity.shear_modulus(p2);
  const double volume_strain = -elasticity.strain_to_pressure(p1, p2);
  if (!move("unloading", -sheared.shear_stress / (2.0 * G1) * shear) || !rest()) return false;
  m_work = 0.0;
  const bool closed = move("loop: shear", q / (2.0 * root_of_3 * G1) * shear) &&
                      move("loop: swelling", volume_strain / 3.0 * swelling) &&
                      move("loop: shear back", -q / (2.0 * root_of_3 * G2) * shear) &&
                      move("loop: compression", -volume_strain / 3.0 * swelling) && rest();
  if (!closed) return false;
  const double exact = q * q / 6.0 * (1.0 / G1 - 1.0 / G2);
  const double work = petsc::sum(m_work) / (side * side * side);
  m_summary.set("loop_work_J_per_m3", work);
  m_summary.set("loop_work_exact_J_per_m3", exact);
  m_summary.set("error_loop_work", work / exact - 1.0);
  return true;
}

/// Torn by turns along y, which shears the sand far, and in all directions.
bool ReversalRun::cycle() {
  const double angle = m_options.amplitude;
  const SymmetricTensor shear{{0, 0, 0, 0.5 * angle, 0, 0}};
  const SymmetricTensor tearing =
      m_cycles_done % 2 == 0 ? SymmetricTensor{{0, 1, 0}} : SymmetricTensor{{1, 1, 1}};
  const bool done =
      move("shear", shear, -0.5 * angle) &&
      move_until("tearing", tearing, [&] { return mean_gap() > 1.0 + m_options.opening; }) &&
      move("shear back, open", -1.0 * shear, 0.5 * angle) &&
      move_until("closing", -1.0 * tearing, [&] { return mean_pressure() >= m_options.pressure; });
  if (done) ++m_cycles_done;
  return done;
}

/// A leg of so much strain and so much rotation about z, at the strain rate of the run.
bool ReversalRun::move(const std::string& name, const SymmetricTensor& strain, double rotation) {
  const double duration = norm(strain) / m_options.strain_rate;
  const run::Clock& clock = m_loop.clock();
  return follow({.name = name,
                 .share_done = [&] { return clock.time_in_stage / duration + 1e-12; },
                 .end_time = duration},
                {(1.0 / duration) * strain, rotation / duration});
}

/// A leg of the strain rate of the run up to a state.
bool ReversalRun::move_until(const std::string& name, const SymmetricTensor& direction,
                             const std::function<bool()>& is_over) {
  const run::Clock& clock = m_loop.clock();
  const auto share = [&, name] {
    if (clock.steps_in_stage > 0 && is_over()) return 1.0;
    if (clock.time_in_stage * m_options.strain_rate > longest_leg)
      throw NumericalFailure(
          fmt::format("{}: a strain of {} does not bring the sand there", name, longest_leg));
    return 0.0;
  };
  return follow({.name = name, .share_done = share},
                {m_options.strain_rate / norm(direction) * direction});
}

/// USF strains one step late: what is left over comes here.
bool ReversalRun::rest() {
  constexpr double steps = 2.0;
  const run::Clock& clock = m_loop.clock();
  return follow({.name = "rest",
                 .share_done = [&] { return static_cast<double>(clock.steps_in_stage) / steps; }},
                {});
}

bool ReversalRun::follow(Stage stage, const MotionRate& rate) {
  m_motion->next = rate;
  stage.after_step = [this] { after_step(); };
  return m_loop.run(stage);
}

void ReversalRun::after_step() {
  const run::Clock& clock = m_loop.clock();
  m_strain = clock.dt * m_motion->next.D;
  if (m_options.run.scheme == solver::Scheme::usf) std::swap(m_strain, m_strain_to_come);
  std::unordered_map<std::int64_t, Before> now;
  {
    const auto view = m_simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      const auto before = m_before.find(view.id[p]);
      // Unknown are those that have just come from another rank.
      if (before != m_before.end()) check(view, p, before->second);
      now.emplace(view.id[p], state_of(view, p));
    }
  }
  m_before = std::move(now);
  const long long every = m_options.run.history_every;
  if (clock.step % (every > 0 ? every : default_rows) == 0) write_row();
}

ReversalRun::Before ReversalRun::state_of(const particles::ParticleView<3>& view, int p) const {
  return {view[m_sand.eps_q][p], view.stress_of(p)};
}

void ReversalRun::check(const particles::ParticleView<3>& view, int p, const Before& before) {
  const Before now = state_of(view, p);
  const SandInvariants stress = m_law.invariants(now.stress);
  const double e = view[m_sand.void_ratio][p];
  const double gap = view[m_sand.gap_volume_ratio][p];
  const double floor = m_options.sand.parameters().pressure_floor;
  m_work += 0.5 * m_particle_volume * contract(before.stress + now.stress, m_strain);
  m_largest_gap = std::max(m_largest_gap, gap);
  const double skeleton = (1.0 + e) / (1.0 + m_options.sand.parameters().void_ratio);
  m_largest_volume_error =
      std::max(m_largest_volume_error,
               std::abs(view.volume[p] / (m_particle_volume * skeleton * gap) - 1.0));
  if (gap > 1.0) {
    const double difference = std::abs(stress.p_star - m_law.gap().p_star(gap));
    m_largest_gap_stress =
        std::max(m_largest_gap_stress, (difference + stress.q) / m_options.pressure);
  }
  if (gap > 1.0 || stress.p_star <= floor * (1.0 + floor_margin)) {
    ++m_at_floor;
    return;
  }
  const double qhat = m_law.surface().at({stress.p_star, e, now.eps_q, stress.sin3theta}).qhat;
  const bool is_plastic = now.eps_q > before.eps_q;
  ++(is_plastic ? m_plastic : m_elastic);
  const double outside = (stress.q - qhat) / stress.p_star;
  m_largest_distance = std::max(m_largest_distance, is_plastic ? std::abs(outside) : outside);
}

ReversalRun::Mean ReversalRun::mean() const {
  SymmetricTensor stress;
  double e = 0.0, eps_q = 0.0;
  {
    const auto view = m_simulation.particles().view();
    for (int p = 0; p < view.count; ++p) {
      stress += state_of(view, p).stress;
      e += view[m_sand.void_ratio][p];
      eps_q += view[m_sand.eps_q][p];
    }
  }
  const auto count = static_cast<double>(m_simulation.particles().global_count());
  for (double& component : stress.components) component = petsc::sum(component) / count;
  return {-trace(stress) / 3.0,
          std::sqrt(1.5) * norm(deviator(stress)),
          stress[3],
          petsc::sum(e) / count,
          petsc::sum(eps_q) / count,
          mean_gap()};
}

double ReversalRun::mean_pressure() const {
  double sum = 0.0;
  {
    const auto view = m_simulation.particles().view();
    for (int p = 0; p < view.count; ++p) sum -= trace(state_of(view, p).stress) / 3.0;
  }
  return petsc::sum(sum) / static_cast<double>(m_simulation.particles().global_count());
}

double ReversalRun::mean_gap() const {
  double sum = 0.0;
  {
    const auto view = m_simulation.particles().view();
    for (int p = 0; p < view.count; ++p) sum += view[m_sand.gap_volume_ratio][p];
  }
  return petsc::sum(sum) / static_cast<double>(m_simulation.particles().global_count());
}

void ReversalRun::write_row() {
  const Mean now = mean();
  const run::Clock& clock = m_loop.clock();
  m_history.row({clock.time, now.p, now.q, now.shear_stress, now.void_ratio, now.eps_q, now.gap,
                 clock.dt, static_cast<double>(clock.step), static_cast<double>(clock.stage)});
}

void ReversalRun::conclude() {
  m_summary.set("cycles_done", m_cycles_done);
  m_summary.set("error_surface", petsc::maximum(m_largest_distance));
  m_summary.set("error_volume", petsc::maximum(m_largest_volume_error));
  m_summary.set("stress_in_gap_max", petsc::maximum(m_largest_gap_stress));
  m_summary.set("gap_volume_ratio_max", petsc::maximum(m_largest_gap));
  const auto plastic = petsc::sum(m_plastic), elastic = petsc::sum(m_elastic);
  const auto at_floor = petsc::sum(m_at_floor);
  const auto all = static_cast<double>(std::max(1LL, plastic + elastic + at_floor));
  m_summary.set("share_plastic", static_cast<double>(plastic) / all);
  m_summary.set("share_at_floor", static_cast<double>(at_floor) / all);
}

class Reversal : public Scene {
 public:
  void declare(options::OptionSet& options) override { m_options.declare(options); }
  const std::string& output_directory() const override { return m_options.run.output_dir; }
  void run(io::Summary& summary) override { ReversalRun(m_options, summary).run(); }

  std::string answer(const io::Summary& summary) const override {
    const std::string cycles =
        fmt::format("{} cycles, state off the surface by {:.2g} of p at most",
                    summary.text("cycles_done"), summary.number("error_surface"));
    if (!summary.has("error_loop_work")) return cycles;
    return fmt::format("{}; work of the elastic loop {:.2g} % off", cycles,
                       100.0 * summary.number("error_loop_work"));
  }

 private:
  ReversalOptions m_options;
};

}  // namespace

std::unique_ptr<Scene> make_reversal() {
  return std::make_unique<Reversal>();
}

}  // namespace mpm::scene
