#include <benchmark/benchmark.h>

#include <array>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "CpuTime.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/material/SandLaw.hpp"
#include "mpm/material/VonMises.hpp"

// What one stress update costs, by law and by what happens in it: a batch of slightly different
// particles in plane strain, brought to a state and then strained by one step's increment. Every
// update starts from that same state, so that nothing drifts however often it is repeated.

namespace mpm::material {
namespace {

constexpr std::size_t particles = 4096;
constexpr std::size_t components = tensor_components<2>;

/// How particles get to the state that is measured, and the increment measured there.
struct Path {
  double pressure = 0.0;          ///< Pa, isotropic, before the preparation
  SymmetricTensor direction{};    ///< of preparation and increment
  double preparation = 0.0;       ///< size of the strain before
  double turning_back = 0.0;      ///< size of the strain back after it
  double increment = 1e-5;        ///< size of the strain that is measured; negative turns back
  double expected_growth = -1.0;  ///< share of particles whose plastic measure grows, or -1
};

class Particles {
 public:
  Particles(const Material& law, const Path& path) : m_law(law) {
    std::mt19937 random(41);
    std::uniform_real_distribution<double> unevenness(-0.02, 0.02);
    for (auto& values : m_now.stress) values.resize(particles);
    for (auto& values : m_direction) values.resize(particles);
    for (std::size_t p = 0; p < particles; ++p) {
      const double pressure = path.pressure * (1.0 + unevenness(random));
      for (std::size_t k = 0; k < 3; ++k) m_now.stress[k][p] = -pressure;
      for (std::size_t k = 0; k < components; ++k)
        m_direction[k][p] = path.direction[static_cast<int>(k)] + unevenness(random);
    }
    for (const StateVariable& variable : law.state_variables())
      m_now.state.emplace_back(particles, variable.initial);
    if (path.pressure > 0.0) law.initialise_from_stress(batch());
    prepare(path.preparation);
    prepare(-path.turning_back);
    strain_next_by(path.increment);
    m_start = m_now;
  }

  /// Not part of the time measured.
  void restore() { m_now = m_start; }

  double update_seconds() {
    const Batch all = batch();
    const double begin = bench::cpu_seconds();
    m_law.update_stress(all);
    return bench::cpu_seconds() - begin;
  }

  /// Share of particles of which the state variable has grown since they were restored.
  double share_grown(std::size_t variable) const {
    double count = 0.0;
    for (std::size_t p = 0; p < particles; ++p)
      if (m_now.state[variable][p] > m_start.state[variable][p]) count += 1.0;
    return count / particles;
  }

 private:
  using Columns = std::array<std::vector<double>, components>;
  struct Values {
    Columns stress;
    std::vector<std::vector<double>> state;
  };

  void strain_next_by(double size) {
    for (std::size_t k = 0; k < components; ++k) {
      m_strain[k].resize(particles);
      for (std::size_t p = 0; p < particles; ++p) m_strain[k][p] = size * m_direction[k][p];
    }
  }

  void prepare(double strain) {
    constexpr int parts = 200;
    if (strain == 0.0) return;
    strain_next_by(strain / parts);
    for (int k = 0; k < parts; ++k) m_law.update_stress(batch());
  }

  Batch batch() {
    Batch all;
    all.size = particles;
    for (std::size_t k = 0; k < components; ++k) {
      all.strain_increment.component[k] = m_strain[k].data();
      all.stress.component[k] = m_now.stress[k].data();
    }
    for (auto& values : m_now.state) all.state.push_back(values.data());
    return all;
  }

  const Material& m_law;
  Columns m_direction, m_strain;
  Values m_now, m_start;
};

/// Refuses a case in which something else happens than its name says.
void check(const std::string& name, const Particles& all, const Path& path, std::size_t variable) {
  if (path.expected_growth < 0.0) return;
  const double share = all.share_grown(variable);
  if (share < path.expected_growth - 0.01 || share > path.expected_growth + 0.01)
    throw NumericalFailure(name + ": state grows in a share " + std::to_string(share) +
                           " of the particles, expected " + std::to_string(path.expected_growth));
}

void add(const std::string& name, const std::shared_ptr<const Material>& law, const Path& path,
         std::size_t variable = 0) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    Particles all(*law, path);
    for (auto _ : state) {
      all.restore();
      state.SetIterationTime(all.update_seconds());
    }
    check(name, all, path, variable);
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * particles));
  })->UseManualTime();
}

const SymmetricTensor biaxial{{0.6, -1.0, 0.0, 0.5, 0.0, 0.0}};
const SymmetricTensor axial{{0.7, -1.0, 0.7, 0.0, 0.0, 0.0}};
const SymmetricTensor stretching{{1.0, 1.0, 1.0, 0.1, 0.0, 0.0}};

void add_elastic_laws() {
  add("elastic", std::make_shared<LinearElastic>(LinearElasticParameters{}),
      {.pressure = 50e3, .direction = biaxial});
  add("neo_hookean", std::make_shared<NeoHookean>(NeoHookeanParameters{}),
      {.direction = biaxial, .preparation = 0.1});
}

void add_perfectly_plastic_laws() {
  const auto clay = std::make_shared<VonMises>(VonMisesParameters{});
  add("von_mises/elastic", clay,
      {.pressure = 50e3, .direction = biaxial, .preparation = 1e-4, .expected_growth = 0.0});
  add("von_mises/plastic", clay,
      {.pressure = 50e3, .direction = biaxial, .preparation = 0.02, .expected_growth = 1.0});
  const auto soil = std::make_shared<MohrCoulomb>(MohrCoulombParameters{.cohesion = 1e3});
  add("mohr_coulomb/elastic", soil,
      {.pressure = 50e3, .direction = biaxial, .preparation = 1e-4, .expected_growth = 0.0});
  add("mohr_coulomb/plane", soil,
      {.pressure = 50e3, .direction = biaxial, .preparation = 0.02, .expected_growth = 1.0});
  add("mohr_coulomb/edge", soil,
      {.pressure = 50e3, .direction = axial, .preparation = 0.02, .expected_growth = 1.0});
  add("mohr_coulomb/apex", soil,
      {.pressure = 5e3, .direction = stretching, .preparation = 0.01, .expected_growth = 1.0});
}

/// Plastic, turning and elastic increments of a size at a pressure.
void add_sand_increments(const std::string& sand, const std::shared_ptr<const SandLaw>& law,
                         double pressure, double size, const std::string& size_text) {
  const std::string at = sand + "/" + std::to_string(static_cast<int>(pressure / 1e3)) + "kPa/";
  Path path{.pressure = pressure, .direction = biaxial, .preparation = 0.01};
  path.increment = size;
  path.expected_growth = 1.0;
  add(at + "plastic" + size_text, law, path, SandLaw::eps_q);
  path.increment = -size;
  path.expected_growth = 0.0;
  add(at + "turning" + size_text, law, path, SandLaw::eps_q);
  path.turning_back = 2e-5;
  add(at + "elastic" + size_text, law, path, SandLaw::eps_q);
}

void add_sand() {
  const auto dense = std::make_shared<SandLaw>(SandParameters{});
  for (double pressure : {2e3, 400e3}) {
    add_sand_increments("sand", dense, pressure, 1e-6, "_1e-6");
    add_sand_increments("sand", dense, pressure, 1e-5, "_1e-5");
  }
  add("sand/pressure_floor", dense,
      {.pressure = 2e3, .direction = stretching, .preparation = 0.05, .expected_growth = 1.0},
      SandLaw::gap_volume_ratio);
}

/// One reading exchanged at a time, to be compared with "sand".
void add_readings_of_sand() {
  const auto add_reading = [](const std::string& name, const auto& choose) {
    SandParameters sand;
    choose(sand);
    const auto law = std::make_shared<SandLaw>(sand);
    for (double pressure : {2e3, 400e3})
      add_sand_increments("sand_" + name, law, pressure, 1e-5, "_1e-5");
  };
  add_reading("lode", [](SandConstants& sand) { sand.dilatancy = Dilatancy::lode; });
  add_reading("bulk_power", [](SandConstants& sand) {
    sand.bulk = BulkModulus::power;
    sand.bulk_xi = 0.7;
  });
  add_reading("bulk_poisson", [](SandConstants& sand) { sand.bulk = BulkModulus::poisson; });
  add_reading("power_line", [](SandConstants& sand) {
    sand.xi = 0.7;
    sand.lambda_c = 0.019;
  });
}

}  // namespace
}  // namespace mpm::material

int main(int count, char** arguments) {
  mpm::material::add_elastic_laws();
  mpm::material::add_perfectly_plastic_laws();
  mpm::material::add_sand();
  mpm::material::add_readings_of_sand();
  benchmark::Initialize(&count, arguments);
  if (benchmark::ReportUnrecognizedArguments(count, arguments)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
