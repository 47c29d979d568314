#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "mpm/core/Errors.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/petsc/Session.hpp"
#include "mpm/solver/Simulation.hpp"
#include "support/Grids.hpp"

namespace mpm::particles {
namespace {

using basis::KnotLines;

Materials two_materials() {
  return {std::make_shared<material::LinearElastic>(material::LinearElasticParameters{
              .youngs_modulus = 3e5, .poisson_ratio = 0.2, .density = 1400.0}),
          std::make_shared<material::NeoHookean>(material::NeoHookeanParameters{
              .youngs_modulus = 2e5, .poisson_ratio = 0.1, .density = 1700.0})};
}

template <int dim>
std::array<KnotLines, dim> lines() {
  if constexpr (dim == 1) return {test::graded_lines(17)};
  if constexpr (dim == 2) return {test::graded_lines(12), KnotLines::uniform(-1.3, 2.9, 15)};
  if constexpr (dim == 3)
    return {test::graded_lines(7), KnotLines::uniform(-0.7, 1.5, 5), test::graded_lines(11)};
}

template <int dim>
double distance(const Vector<dim>& a, const Vector<dim>& b) {
  double square = 0.0;
  for (int d = 0; d < dim; ++d) square += (a[d] - b[d]) * (a[d] - b[d]);
  return std::sqrt(square);
}

template <int dim>
Vector<dim> middle() {
  Vector<dim> x;
  for (int d = 0; d < dim; ++d) x[d] = 0.5 * (lines<dim>()[d].begin() + lines<dim>()[d].end());
  return x;
}

/// Everywhere full; the second material near the middle.
template <int dim>
Filling<dim> full() {
  return {[](const Vector<dim>& x) { return distance<dim>(x, middle<dim>()) < 0.8 ? 1 : 0; },
          [](const Vector<dim>& x) { return x[0] < 1.7 ? 2 : 3; }};
}

template <int dim>
std::vector<Seed<dim>> seeds_of(const grid::CellSet<dim>& cells, const Filling<dim>& filling) {
  std::vector<Seed<dim>> seeds;
  cells.for_each([&](const auto& cell) {
    const auto more = seeds_of_cell<dim>(lines<dim>(), cell, filling);
    seeds.insert(seeds.end(), more.begin(), more.end());
  });
  return seeds;
}

template <int dim>
grid::Box<dim> all_cells() {
  grid::Box<dim> box;
  for (int d = 0; d < dim; ++d) box.end[d] = lines<dim>()[d].cells();
  return box;
}

/// Particles on a grid with uneven ownership.
template <int dim>
struct Swarm {
  explicit Swarm(const Filling<dim>& filling = full<dim>()) {
    particles.add(seeds_of<dim>(grid.owned_cells(), filling));
  }
  std::array<basis::NodeLine, dim> nodes = test::node_lines<dim>(test::splines<dim>(lines<dim>()));
  grid::Grid<dim> grid{test::world(), nodes, test::uneven_layout<dim>(nodes)};
  Particles<dim> particles{grid, two_materials(), {.velocity_gradient = true}};
};

/// Calls visit(value, number of the column) for every real column of a particle but its position.
template <int dim, class Visit>
void for_each_column(const Particles<dim>& particles, const ParticleView<dim>& view, int p,
                     const Visit& visit) {
  int column = 0;
  for (const Field<dim>& field : particles.fields().all()) {
    const bool is_real = field.shape != Shape::integer && field.shape != Shape::id;
    if (!is_real || field.role == Role::derived || field.name == "position") continue;
    const StateHandle handle = particles.fields().handle(field.name);
    for (int k = 0; k < FieldTable<dim>::components(field.shape); ++k)
      visit(view.column(handle, k)[p], column++);
  }
}

/// A number with all its bits in use that tells particles and columns apart.
double mark(std::int64_t id, int column) {
  return std::sin(0.37 * static_cast<double>(id) + 1.9 * column) * std::exp(column - 4.0);
}

template <int dim>
void mark_fields(const Particles<dim>& particles) {
  const auto view = particles.view();
  for (int p = 0; p < view.count; ++p)
    for_each_column(particles, view, p,
                    [&](double& value, int column) { value = mark(view.id[p], column); });
}

/// By a share of the length in every direction, coming in again at the other end.
template <int dim>
Vector<dim> moved(Vector<dim> x, double share) {
  for (int d = 0; d < dim; ++d) {
    const double begin = lines<dim>()[d].begin(), length = lines<dim>()[d].end() - begin;
    x[d] = begin + std::fmod(x[d] - begin + share * length, length);
  }
  return x;
}

template <int dim>
void migration_brings_every_particle_home_bit_for_bit(double share) {
  Swarm<dim> swarm;
  Particles<dim>& particles = swarm.particles;
  const long long count = particles.global_count();
  mark_fields(particles);
  {
    const auto view = particles.view();
    for (int p = 0; p < view.count; ++p) {
      const Vector<dim> x = moved<dim>(view.position_of(p), share);
      for (int d = 0; d < dim; ++d) view.position[d][p] = x[d];
    }
  }
  particles.migrate();

  EXPECT_EQ(particles.global_count(), count);
  const auto seeds = seeds_of<dim>(all_cells<dim>(), full<dim>());
  EXPECT_EQ(static_cast<long long>(seeds.size()), count);
  std::vector<std::int64_t> ids;
  const auto view = particles.view();
  for (int p = 0; p < view.count; ++p) {
    ids.push_back(view.id[p]);
    const auto seed = std::ranges::find(seeds, view.id[p], &Seed<dim>::id);
    EXPECT_NE(seed, seeds.end());
    if (seed == seeds.end()) continue;
    EXPECT_EQ(view.position_of(p), moved<dim>(seed->position, share));
    EXPECT_EQ(view.material[p], seed->material);
    EXPECT_EQ(swarm.grid.rank_of_cell(swarm.grid.cell_of(view.position_of(p))), test::world_rank());
    for_each_column(particles, view, p, [&](double& value, int column) {
      EXPECT_EQ(value, mark(view.id[p], column)) << "column " << column;
    });
  }
  ids = test::of_all_ranks(ids);
  std::ranges::sort(ids);
  EXPECT_EQ(std::ranges::adjacent_find(ids), ids.end());
  EXPECT_EQ(static_cast<long long>(ids.size()), count);
}

TEST(Migration, brings_every_particle_home_bit_for_bit) {
  for (double share : {0.03, 0.55}) {  // to a neighbour; past one
    migration_brings_every_particle_home_bit_for_bit<1>(share);
    migration_brings_every_particle_home_bit_for_bit<2>(share);
    migration_brings_every_particle_home_bit_for_bit<3>(share);
  }
}

TEST(Migration, there_and_back_leaves_every_rank_with_its_own) {
  Swarm<2> swarm;
  const auto before = test::snapshots(swarm.particles);
  const int local = swarm.particles.local_count();
  for (double sign : {1.0, -1.0}) {
    {
      const auto view = swarm.particles.view();
      for (int p = 0; p < view.count; ++p) view.position[1][p] *= sign < 0.0 ? 2.0 : 0.5;
    }
    swarm.particles.migrate();
  }
  EXPECT_EQ(swarm.particles.local_count(), local);
  EXPECT_EQ(test::snapshots(swarm.particles).size(), before.size());
}

TEST(Migration, works_where_ranks_have_no_particles) {
  Filling<2> corner = full<2>();
  corner.material_at = [](const Vector<2>& x) {
    return x[0] < 0.7 && x[1] < -1.0 ? std::optional(1) : std::nullopt;
  };
  Swarm<2> swarm(corner);
  const long long count = swarm.particles.global_count();
  ASSERT_GT(count, 0);
  EXPECT_EQ(petsc::minimum(swarm.particles.local_count()) == 0.0, test::world_size() > 1);
  mark_fields(swarm.particles);
  {
    const auto view = swarm.particles.view();
    for (int p = 0; p < view.count; ++p) view.position[0][p] += 2.5, view.position[1][p] += 3.7;
  }
  swarm.particles.migrate();
  const auto view = swarm.particles.view();
  EXPECT_EQ(petsc::sum(static_cast<long long>(view.count)), count);
  EXPECT_EQ(view.count > 0, test::world_rank() == test::world_size() - 1);
  for (int p = 0; p < view.count; ++p)
    for_each_column(swarm.particles, view, p,
                    [&](double& value, int column) { EXPECT_EQ(value, mark(view.id[p], column)); });
}

TEST(Migration, a_particle_outside_the_grid_stops_all_ranks) {
  for (double outside : {1e3, -1e3, std::nan("")}) {
    Swarm<2> swarm;
    {
      const auto view = swarm.particles.view();
      for (int p = 0; p < view.count; ++p)
        if (view.id[p] == 3 * 4096 + 1) view.position[1][p] = outside;
    }
    EXPECT_THROW(swarm.particles.migrate(), NumericalFailure) << outside;
  }
}

template <int dim>
void sorting_keeps_the_set_and_orders_by_material_then_cell() {
  Swarm<dim> swarm;
  Particles<dim>& particles = swarm.particles;
  const auto before = test::snapshots(particles);
  {  // turned round within this rank
    const auto view = particles.view();
    for (int p = 0, q = view.count - 1; p < q; ++p, --q) {
      for (int d = 0; d < dim; ++d) std::swap(view.position[d][p], view.position[d][q]);
      std::swap(view.id[p], view.id[q]);
      std::swap(view.material[p], view.material[q]);
      std::swap(view.volume[p], view.volume[q]);
    }
  }
  particles.sort();
  EXPECT_EQ(test::snapshots(particles), before);
  const auto view = particles.view();
  auto key = [&](int p) {
    const auto cell = swarm.grid.cell_of(view.position_of(p));
    return std::pair(view.material[p], swarm.grid.reachable_cells().box().index_of(cell));
  };
  for (int p = 1; p < view.count; ++p) EXPECT_LE(key(p - 1), key(p));
  for (int material : {0, 1}) {
    const auto range = particles.range_of(material);
    EXPECT_EQ(range.first, material == 0 ? 0 : particles.range_of(0).last);
    for (int p = range.first; p < range.last; ++p) EXPECT_EQ(view.material[p], material);
  }
  EXPECT_EQ(particles.range_of(1).last, view.count);
}

TEST(Sorting, keeps_the_set_and_orders_by_material_then_cell) {
  sorting_keeps_the_set_and_orders_by_material_then_cell<1>();
  sorting_keeps_the_set_and_orders_by_material_then_cell<2>();
  sorting_keeps_the_set_and_orders_by_material_then_cell<3>();
}

TEST(Particles, start_with_the_mass_of_their_material_and_its_state) {
  Swarm<2> swarm;
  const StateHandle volume_ratio = swarm.particles.state(1, "volume_ratio");
  const auto view = swarm.particles.view();
  for (int p = 0; p < view.count; ++p) {
    EXPECT_EQ(view.mass[p], view.volume[p] * (view.material[p] == 0 ? 1400.0 : 1700.0));
    EXPECT_EQ(view[volume_ratio][p], view.material[p] == 0 ? 0.0 : 1.0);
  }
}

TEST(Particles, memory_of_one_is_that_of_its_columns) {
  Swarm<2> swarm;
  // Position, velocity, displacement, 4 stresses, mass, volume, strain, one state, 4 gradients;
  // material; id.
  EXPECT_EQ(swarm.particles.bytes_per_particle(), 18 * 8u + sizeof(PetscInt) + 8u);
}

// State of the laws ------------------------------------------------------------------------------

/// A law with any state; it does nothing.
class Keeper : public material::LinearElastic {
 public:
  Keeper(std::string name, std::vector<material::StateVariable> variables)
      : LinearElastic({.youngs_modulus = 3e5, .poisson_ratio = 0.2, .density = 1400.0}),
        m_name(std::move(name)),
        m_variables(std::move(variables)) {}
  std::string_view name() const override { return m_name; }
  std::span<const material::StateVariable> state_variables() const override { return m_variables; }

 private:
  std::string m_name;
  std::vector<material::StateVariable> m_variables;
};

/// Two laws that share a variable, which both declare second or third.
Materials keepers(bool swapped) {
  Materials laws{
      std::make_shared<Keeper>(
          "silt",
          std::vector<material::StateVariable>{{"water", "content of water", "1", 0.2},
                                               {"age", "time since it was laid", "s", 3.0}}),
      std::make_shared<Keeper>("clay", std::vector<material::StateVariable>{
                                           {"salt", "content of salt", "1", 0.03},
                                           {"water", "content of water", "1", 0.7},
                                           {"age", "time since it was laid", "s", 5.0}})};
  if (swapped) std::swap(laws[0], laws[1]);
  return laws;
}

/// Particles of the two laws, silt in the left half whatever its number.
struct Layers {
  explicit Layers(bool swapped)
      : silt(swapped ? 1 : 0), clay(1 - silt), particles(grid, keepers(swapped)) {
    const Filling<2> filling{[&](const Vector<2>& x) { return x[0] < 1.7 ? silt : clay; },
                             [](const auto&) { return 2; }};
    particles.add(seeds_of<2>(grid.owned_cells(), filling));
  }
  int silt, clay;
  std::array<basis::NodeLine, 2> nodes = test::node_lines<2>(test::splines<2>(lines<2>()));
  grid::Grid<2> grid{test::world(), nodes, test::uneven_layout<2>(nodes)};
  Particles<2> particles;
};

TEST(State, starts_as_its_law_says_and_is_found_by_name_in_either_order_of_the_laws) {
  for (const bool swapped : {false, true}) {
    Layers layers(swapped);
    const Particles<2>& particles = layers.particles;
    const StateHandle silt_water = particles.state(layers.silt, "water"),
                      silt_age = particles.state(layers.silt, "age"),
                      clay_salt = particles.state(layers.clay, "salt"),
                      clay_water = particles.state(layers.clay, "water"),
                      clay_age = particles.state(layers.clay, "age");
    const auto view = particles.view();
    for (int p = 0; p < view.count; ++p) {
      const bool is_silt = view.position[0][p] < 1.7;
      EXPECT_EQ(view[is_silt ? silt_water : clay_water][p], is_silt ? 0.2 : 0.7);
      EXPECT_EQ(view[is_silt ? silt_age : clay_age][p], is_silt ? 3.0 : 5.0);
      EXPECT_EQ(view[clay_salt][p], is_silt ? 0.0 : 0.03);
    }
  }
}

TEST(State, goes_with_its_particle_in_either_order_of_the_laws) {
  for (const bool swapped : {false, true}) {
    Layers layers(swapped);
    Particles<2>& particles = layers.particles;
    const std::array handles{particles.state(layers.silt, "age"),
                             particles.state(layers.clay, "salt"),
                             particles.state(layers.clay, "water")};
    {
      const auto view = particles.view();
      for (int p = 0; p < view.count; ++p) {
        for (std::size_t h = 0; h < handles.size(); ++h)
          view[handles[h]][p] = mark(view.id[p], static_cast<int>(h));
        const Vector<2> x = moved<2>(view.position_of(p), 0.55);
        for (int d = 0; d < 2; ++d) view.position[d][p] = x[d];
      }
    }
    particles.migrate();
    const auto view = particles.view();
    for (int p = 0; p < view.count; ++p)
      for (std::size_t h = 0; h < handles.size(); ++h)
        EXPECT_EQ(view[handles[h]][p], mark(view.id[p], static_cast<int>(h)));
  }
}

TEST(State, reaches_its_law_in_the_order_that_the_law_declares) {
  for (const bool swapped : {false, true}) {
    Layers layers(swapped);
    const auto view = layers.particles.view();
    const material::Batch batch = layers.particles.batch_of(view, layers.clay);
    ASSERT_EQ(batch.state.size(), 3u);
    const std::array initial{0.03, 0.7, 5.0};
    for (std::size_t s = 0; s < 3; ++s)
      for (std::size_t p = 0; p < batch.size; ++p) EXPECT_EQ(batch.state[s][p], initial[s]);
  }
}

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const BadInput& error) {
    return error.what();
  }
  return "not refused";
}

TEST(State, that_a_law_does_not_have_is_refused_with_its_name_and_what_it_has) {
  const Layers layers(true);
  EXPECT_EQ(refusal([&] { layers.particles.state(layers.silt, "salt"); }),
            "law 'silt' of material 1 has no state variable 'salt'; it has water, age");
}

TEST(Fields, of_one_name_and_different_units_are_refused) {
  const auto table_with = [](const std::string& name, const std::string& unit) {
    const FieldTable<2> table(
        {std::make_shared<Keeper>("silt",
                                  std::vector<material::StateVariable>{{"age", "age", "s", 0.0}}),
         std::make_shared<Keeper>("clay",
                                  std::vector<material::StateVariable>{{name, "age", unit, 0.0}})},
        {});
  };
  EXPECT_EQ(refusal([&] { table_with("age", "s"); }), "not refused");
  EXPECT_NE(refusal([&] { table_with("age", "day"); }).find("law 'clay' declares 'age' in day"),
            std::string::npos);
  EXPECT_NE(refusal([&] { table_with("volume", "m^3"); }).find("law 'clay' declares 'volume'"),
            std::string::npos);
}

TEST(Fields, that_have_no_columns_of_a_kind_give_no_handle) {
  const Swarm<2> swarm;
  const FieldTable<2>& fields = swarm.particles.fields();
  EXPECT_THROW(fields.handle("q"), BadInput);
  EXPECT_THROW(fields.handle("id"), BadInput);
  EXPECT_THROW(fields.handle("material"), BadInput);  // whole numbers
  EXPECT_THROW(fields.handle<PetscInt>("mass"), BadInput);
  EXPECT_THROW(fields.handle("volumes"), BadInput);
}

TEST(Fields, start_at_their_initial_value_in_every_component) {
  const Swarm<2> swarm;
  const auto view = swarm.particles.view();
  for (const Field<2>& field : swarm.particles.fields().all()) {
    if (field.name != "velocity" && field.name != "velocity_gradient" && field.name != "stress")
      continue;
    for (int k = 0; k < FieldTable<2>::components(field.shape); ++k) {
      const double* values = view.column(swarm.particles.fields().handle(field.name), k);
      for (int p = 0; p < view.count; ++p) EXPECT_EQ(values[p], 0.0) << field.name << k;
    }
  }
}

// Seeding ---------------------------------------------------------------------------------------

template <int dim>
void ids_are_unique_and_independent_of_the_ranks() {
  solver::SimulationSetup<dim> setup{.lines = lines<dim>()};
  setup.materials = two_materials();
  setup.filling = full<dim>();
  const solver::Simulation<dim> simulation(setup);
  const auto made = test::snapshots(simulation.particles());
  auto seeds = seeds_of<dim>(all_cells<dim>(), full<dim>());
  std::ranges::sort(seeds, {}, &Seed<dim>::id);
  ASSERT_EQ(made.size(), seeds.size());
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    EXPECT_EQ(made[k].id, seeds[k].id);
    EXPECT_EQ(made[k].position, seeds[k].position);
    EXPECT_TRUE(k == 0 || seeds[k - 1].id < seeds[k].id);
  }
}

TEST(Seeding, ids_are_unique_and_independent_of_the_ranks) {
  ids_are_unique_and_independent_of_the_ranks<1>();
  ids_are_unique_and_independent_of_the_ranks<2>();
  ids_are_unique_and_independent_of_the_ranks<3>();
}

template <int dim>
void volumes_add_up_to_the_body() {
  double box = 1.0;
  for (const KnotLines& line : lines<dim>()) box *= line.end() - line.begin();
  for (const Placement placement : {Placement::midpoint, Placement::gauss})
    for (int n : {1, 2, 3}) {
      const Filling<dim> filling{[](const auto&) { return 0; }, [n](const auto&) { return n; },
                                 placement};
      double sum = 0.0;
      for (const Seed<dim>& seed : seeds_of<dim>(all_cells<dim>(), filling)) sum += seed.volume;
      EXPECT_NEAR(sum / box, 1.0, 1e-13);
    }
}

TEST(Seeding, volumes_add_up_to_the_body) {
  volumes_add_up_to_the_body<1>();
  volumes_add_up_to_the_body<2>();
  volumes_add_up_to_the_body<3>();
}

TEST(Seeding, volume_of_a_disc_is_met_by_small_particles) {
  const double radius = 1.1;
  const Vector<2> centre{2.0, 0.8};
  const Filling<2> disc{[&](const Vector<2>& x) {
                          return distance<2>(x, centre) < radius ? std::optional(1) : std::nullopt;
                        },
                        [](const auto&) { return 8; }};
  double sum = 0.0;
  for (const Seed<2>& seed : seeds_of<2>(all_cells<2>(), disc)) sum += seed.volume;
  EXPECT_NEAR(sum / (std::numbers::pi * radius * radius), 1.0, 5e-3);
}

TEST(Seeding, gauss_points_integrate_what_they_should) {
  for (int n : {1, 2, 3}) {
    const Filling<1> gauss{[](const auto&) { return 0; }, [n](const auto&) { return n; },
                           Placement::gauss};
    const int power = 2 * n - 1;  // the highest they are exact for
    const double begin = lines<1>()[0].begin(), end = lines<1>()[0].end();
    double sum = 0.0;
    for (const Seed<1>& seed : seeds_of<1>(all_cells<1>(), gauss))
      sum += seed.volume * std::pow(seed.position[0], power);
    const double exact = (std::pow(end, power + 1) - std::pow(begin, power + 1)) / (power + 1);
    EXPECT_NEAR(sum / exact, 1.0, 1e-13);
  }
}

TEST(Seeding, more_gauss_points_than_there_are_are_refused) {
  const Filling<2> gauss{[](const auto&) { return 0; }, [](const auto&) { return 4; },
                         Placement::gauss};
  EXPECT_THROW(seeds_of_cell<2>(lines<2>(), {1, 2}, gauss), BadInput);
}

TEST(Seeding, a_body_without_particles_is_refused_on_all_ranks) {
  solver::SimulationSetup<2> setup{.lines = lines<2>()};
  setup.materials = two_materials();
  setup.filling = {[](const auto&) { return std::nullopt; }, [](const auto&) { return 2; }};
  EXPECT_THROW(solver::Simulation<2>{setup}, BadInput);
}

TEST(Seeding, too_many_ranks_for_the_grid_are_refused_on_all_ranks) {
  solver::SimulationSetup<1> setup{.lines = {KnotLines::uniform(0.2, 1.9, 4)}};  // 7 nodes
  setup.materials = two_materials();
  setup.filling = {[](const auto&) { return 0; }, [](const auto&) { return 2; }};
  if (test::world_size() > 2)
    EXPECT_THROW(solver::Simulation<1>{setup}, BadInput);
  else
    EXPECT_EQ(solver::Simulation<1>{setup}.particles().global_count(), 8);
}

}  // namespace
}  // namespace mpm::particles
