#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "CpuTime.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/material/SandLaw.hpp"
#include "mpm/material/VonMises.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/solver/Simulation.hpp"

// Which share of a step each law takes: a box of 20000 particles on 5000 cells in plane strain on
// one rank, stirred slowly.

namespace mpm {
namespace {

constexpr double width = 1.0, height = 0.5;  // m
constexpr int cells = 100;                   // over the width
constexpr int warm_up = 20, steps = 30, repetitions = 9;

/// Measures the stress updates of another law.
class TimedLaw : public material::Material {
 public:
  explicit TimedLaw(std::unique_ptr<Material> law) : m_law(std::move(law)) {}

  std::string_view name() const override { return m_law->name(); }
  std::span<const material::StateVariable> state_variables() const override {
    return m_law->state_variables();
  }
  double initial_density() const override { return m_law->initial_density(); }
  void update_stress(const material::Batch& batch) const override {
    const double begin = bench::cpu_seconds();
    m_law->update_stress(batch);
    m_seconds += bench::cpu_seconds() - begin;
  }
  void wave_modulus(const material::Batch& batch, std::span<double> modulus) const override {
    m_law->wave_modulus(batch, modulus);
  }
  void initialise_from_stress(const material::Batch& batch) const override {
    m_law->initialise_from_stress(batch);
  }

  double take_seconds() const { return std::exchange(m_seconds, 0.0); }

 private:
  std::unique_ptr<Material> m_law;
  mutable double m_seconds = 0.0;
};

/// Leaves the stress as it is: what is left of the step without a law.
class NoLaw : public material::Material {
 public:
  std::string_view name() const override { return "none"; }
  std::span<const material::StateVariable> state_variables() const override { return {}; }
  double initial_density() const override { return 1700.0; }
  void update_stress(const material::Batch&) const override {}
  void wave_modulus(const material::Batch& batch, std::span<double> modulus) const override {
    std::fill_n(modulus.begin(), batch.size, 30e6);
  }
  void initialise_from_stress(const material::Batch&) const override {}
};

solver::SimulationSetup<2> box(std::shared_ptr<const material::Material> law) {
  solver::SimulationSetup<2> setup{
      .lines = {basis::KnotLines::uniform(0.0, width, cells),
                basis::KnotLines::uniform(0.0, height, static_cast<int>(cells * height / width))}};
  for (auto& direction : setup.walls) direction = {grid::Wall::roller, grid::Wall::roller};
  setup.materials = {std::move(law)};
  setup.filling = {[](const auto&) { return 0; }, [](const auto&) { return 2; }};
  return setup;
}

/// 50 kPa on 25 kPa, and a vortex without flow through the walls that strains by up to 0.16 per
/// second: some 5e-6 a step.
void stress_and_stir(solver::Simulation<2>& simulation) {
  constexpr double pi = std::numbers::pi, speed = 0.05;
  auto& particles = simulation.particles();
  const auto view = particles.view();
  for (int p = 0; p < view.count; ++p) {
    const Vector<2> x = view.position_of(p);
    view.velocity[0][p] = speed * std::sin(pi * x[0] / width) * std::cos(pi * x[1] / height);
    view.velocity[1][p] =
        -speed * height / width * std::cos(pi * x[0] / width) * std::sin(pi * x[1] / height);
    view.stress[0][p] = view.stress[2][p] = -25e3;
    view.stress[1][p] = -50e3;
  }
  particles.materials()[0]->initialise_from_stress(particles.batch_of(view, 0));
}

/// Share of the particles of which a state variable grows in the next step.
double share_growing(solver::Simulation<2>& simulation, const std::string& variable) {
  std::vector<double> before;
  const auto count = static_cast<std::size_t>(simulation.particles().local_count());
  const particles::StateHandle state = simulation.particles().state(0, variable);
  {
    const auto view = simulation.particles().view();
    before.assign(view[state], view[state] + count);
  }
  simulation.advance(0.0, simulation.plan());
  const auto view = simulation.particles().view();
  double growing = 0.0;
  for (std::size_t p = 0; p < count; ++p)
    if (view[state][p] > before[p]) growing += 1.0;
  return growing / static_cast<double>(count);
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// `plastic_measure` is the state variable that grows where the law is plastic, "" if it never is.
void measure(const std::string& name, std::unique_ptr<material::Material> made,
             const std::string& plastic_measure) {
  const auto law = std::make_shared<TimedLaw>(std::move(made));
  solver::Simulation<2> simulation(box(law));
  stress_and_stir(simulation);
  for (int k = 0; k < warm_up; ++k) simulation.advance(0.0, simulation.plan());
  const double plastic = plastic_measure.empty() ? 0.0 : share_growing(simulation, plastic_measure);
  std::vector<double> of_law, of_step;
  const double updates = steps * static_cast<double>(simulation.particles().local_count());
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    law->take_seconds();
    const double begin = bench::cpu_seconds();
    for (int k = 0; k < steps; ++k) simulation.advance(0.0, simulation.plan());
    of_step.push_back((bench::cpu_seconds() - begin) / updates);
    of_law.push_back(law->take_seconds() / updates);
  }
  fmt::print("{},{:.2f},{:.1f},{:.1f}\n", name, plastic, 1e9 * median(of_law),
             1e9 * median(of_step));
}

void measure_all() {
  using namespace material;
  fmt::print("law,plastic_share,law_ns_per_particle,step_ns_per_particle\n");
  measure("none", std::make_unique<NoLaw>(), "");
  measure("elastic",
          std::make_unique<LinearElastic>(
              LinearElasticParameters{.youngs_modulus = 25e6, .density = 1700.0}),
          "");
  // Both start at their strength, so that half of the box yields and half unloads.
  measure("von_mises",
          std::make_unique<VonMises>(VonMisesParameters{
              .elastic = {.youngs_modulus = 25e6, .density = 1700.0}, .shear_strength = 14.434e3}),
          "plastic_strain");
  measure("mohr_coulomb",
          std::make_unique<MohrCoulomb>(MohrCoulombParameters{
              .elastic = {.youngs_modulus = 25e6, .density = 1700.0}, .friction_angle = 19.4713}),
          "plastic_strain");
  measure("sand", std::make_unique<SandLaw>(SandParameters{}), "eps_q");
}

}  // namespace
}  // namespace mpm

int main() {
  const mpm::petsc::Session session;
  mpm::measure_all();
}
