#include <fmt/format.h>

#include "ReversalCube.hpp"
#include "mpm/cases/GridCase.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {
namespace {

using namespace reversal;

/// A cube of sand that is moved homogeneously by its nodes. First a closed loop of isotropic
/// pressure and shear inside the loading surface: G depends on p, so it does the work
/// (q^2/6)(1/G1 - 1/G2) per volume. Then cycles: sheared, torn until a gap opens, sheared back
/// while open, closed and pressed together again. The state has to stay on the loading surface
/// while eps_q grows and never lie outside it; an open gap carries what its opening leaves of the
/// cohesion. Three dimensions, since plane strain knows no isotropic swelling.
class Reversal : public GridCase<3> {
 public:
  void declare(options::OptionSet& options) override { m_cube.declare(options); }

  std::string answer(const io::Summary& summary) const override {
    const std::string cycles =
        fmt::format("{} cycles, state off the surface by {:.2g} of p at most",
                    summary.text("cycles_done"), summary.number("error_surface"));
    if (!summary.has("error_loop_work")) return cycles;
    return fmt::format("{}; work of the elastic loop {:.2g} % off", cycles,
                       100.0 * summary.number("error_loop_work"));
  }

 private:
  const run::RunOptions& run_options() const override { return m_cube.run; }
  run::Problem<3> problem() override;
  void evaluate(run::Run<3>& run, io::Summary& summary) override;
  void add_loop(run::Problem<3>& problem);
  void add_cycle(run::Problem<3>& problem, std::int64_t number);
  void add_leg(run::Problem<3>& problem, const std::string& name, Leg::Strain strain,
               double rotation = 0.0) const;
  void add_open_leg(run::Problem<3>& problem, const std::string& name,
                    const SymmetricTensor& direction, OpenLeg::IsOver is_over) const;
  /// USF strains one step late: what is left over comes in two steps of rest.
  void add_rest(run::Problem<3>& problem) const;
  void plan_loop(const run::Moment<3>& now);
  run::HistoryTable<3> history() const;

  ReversalOptions m_cube;
  std::shared_ptr<PrescribedMotion> m_motion;
  std::shared_ptr<CubeObserver> m_observer;
  std::shared_ptr<LoopPlan> m_loop;
};

run::Problem<3> Reversal::problem() {
  m_motion = std::make_shared<PrescribedMotion>();
  m_observer = std::make_shared<CubeObserver>(m_cube, m_motion);
  m_loop = std::make_shared<LoopPlan>();
  run::Problem<3> problem{.setup = m_cube.setup()};
  problem.initial_stress = [pressure = m_cube.pressure](const Vector<3>&) {
    return SymmetricTensor{{-pressure, -pressure, -pressure, 0.0, 0.0, 0.0}};
  };
  problem.constraints = {[this](const auto&) { return m_motion; }};
  problem.observers = {m_observer, m_loop, std::make_shared<run::History<3>>(history())};
  add_loop(problem);
  for (std::int64_t k = 0; k < m_cube.cycles; ++k) add_cycle(problem, k);
  return problem;
}

/// Pure shear at p1, swelling to p2, shear back, compression to p1: every leg elastic.
void Reversal::add_loop(run::Problem<3>& problem) {
  const SymmetricTensor shear{{0, 0, 0, 1, 0, 0}}, swelling{{1, 1, 1, 0, 0, 0}};
  const auto along = [this](const SymmetricTensor& direction, double LoopPlan::*size, double sign) {
    return [=, this] { return sign * (*m_loop).*size * direction; };
  };
  add_leg(problem, "room for a loop", [shear] { return room_strain * shear; });
  add_rest(problem);
  problem.stages.back().at_end = [this](const run::Moment<3>& now) { plan_loop(now); };
  add_leg(problem, "unloading", along(shear, &LoopPlan::unloading, -1.0));
  add_rest(problem);
  problem.stages.back().at_end = [this](const run::Moment<3>&) { m_observer->forget_work(); };
  add_leg(problem, "loop: shear", along(shear, &LoopPlan::shear, 1.0));
  add_leg(problem, "loop: swelling", along(swelling, &LoopPlan::swelling, 1.0));
  add_leg(problem, "loop: shear back", along(shear, &LoopPlan::shear_back, -1.0));
  add_leg(problem, "loop: compression", along(swelling, &LoopPlan::swelling, -1.0));
  add_rest(problem);
  problem.stages.back().at_end = [this](const run::Moment<3>& now) {
    const double work = now.simulation.communicator().sum(m_observer->work());
    m_loop->work = work / (side * side * side);
    m_loop->is_closed = true;
  };
}

void Reversal::plan_loop(const run::Moment<3>& now) {
  const SandLaw& law = m_observer->law();
  const material::SandElasticity& elasticity = law.surface().elasticity();
  // Without cohesion's shift, which p* holds and p does not.
  const double shift = law.invariants({}).p_star;
  const Mean sheared = m_observer->mean(now.simulation);
  const double p1 = sheared.p + shift, p2 = loop_pressure * p1, q = loop_stress * p1;
  const double G1 = elasticity.shear_modulus(p1), G2 = elasticity.shear_modulus(p2);
  m_loop->unloading = sheared.shear_stress / (2.0 * G1);
  m_loop->shear = q / (2.0 * root_of_3 * G1);
  m_loop->swelling = -elasticity.strain_to_pressure(p1, p2) / 3.0;
  m_loop->shear_back = q / (2.0 * root_of_3 * G2);
  m_loop->exact_work = q * q / 6.0 * (1.0 / G1 - 1.0 / G2);
}

/// Torn by turns along y, which shears the sand far, and in all directions.
void Reversal::add_cycle(run::Problem<3>& problem, std::int64_t number) {
  const double angle = m_cube.amplitude;
  const SymmetricTensor shear{{0, 0, 0, 0.5 * angle, 0, 0}};
  const SymmetricTensor tearing =
      number % 2 == 0 ? SymmetricTensor{{0, 1, 0}} : SymmetricTensor{{1, 1, 1}};
  add_leg(
      problem, "shear", [shear] { return shear; }, -0.5 * angle);
  add_open_leg(problem, "tearing", tearing, [this](const run::Moment<3>& now) {
    return m_observer->mean_gap(now.simulation) > 1.0 + m_cube.opening;
  });
  add_leg(
      problem, "shear back, open", [shear] { return -1.0 * shear; }, 0.5 * angle);
  add_open_leg(problem, "closing", -1.0 * tearing, [this](const run::Moment<3>& now) {
    return m_observer->mean_pressure(now.simulation) >= m_cube.pressure;
  });
  problem.stages.back().at_end = [this](const run::Moment<3>&) { ++m_loop->cycles_done; };
}

void Reversal::add_leg(run::Problem<3>& problem, const std::string& name, Leg::Strain strain,
                       double rotation) const {
  problem.stages.push_back(
      {.name = name,
       .ending = std::make_shared<Leg>(m_motion, std::move(strain), rotation, m_cube.strain_rate)});
}

void Reversal::add_open_leg(run::Problem<3>& problem, const std::string& name,
                            const SymmetricTensor& direction, OpenLeg::IsOver is_over) const {
  problem.stages.push_back({.name = name,
                            .ending = std::make_shared<OpenLeg>(
                                m_motion, direction, m_cube.strain_rate, std::move(is_over))});
}

void Reversal::add_rest(run::Problem<3>& problem) const {
  problem.stages.push_back({.name = "rest", .ending = std::make_shared<Pause>(m_motion)});
}

run::HistoryTable<3> Reversal::history() const {
  return {.path = path("history.csv"),
          .columns = {"time_s", "p_Pa", "q_Pa", "shear_stress_Pa", "void_ratio", "eps_q",
                      "gap_volume_ratio", "stage"},
          .row =
              [this](const run::Moment<3>& now) {
                const Mean mean = m_observer->mean(now.simulation);
                return std::vector<double>{
                    now.clock.time,  mean.p,     mean.q,   mean.shear_stress,
                    mean.void_ratio, mean.eps_q, mean.gap, static_cast<double>(now.clock.stage)};
              },
          .cadence = run::Cadence<3>(default_rows).or_every(m_cube.run.history_every),
          .columns_before_clock = 7,
          .has_first_row = true};
}

void Reversal::evaluate(run::Run<3>& run, io::Summary& summary) {
  if (m_loop->is_closed) {
    summary.set("loop_work_J_per_m3", m_loop->work);
    summary.set("loop_work_exact_J_per_m3", m_loop->exact_work);
    summary.set("error_loop_work", m_loop->work / m_loop->exact_work - 1.0);
  }
  summary.set("cycles_done", m_loop->cycles_done);
  m_observer->report(run.simulation().communicator(), summary);
}

}  // namespace

std::unique_ptr<Case> make_reversal() {
  return std::make_unique<Reversal>();
}

}  // namespace mpm::cases
