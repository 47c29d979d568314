#include "mpm/solver/Regularisation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>

#include "mpm/core/Errors.hpp"
#include "mpm/material/SandLaw.hpp"
#include "support/Grids.hpp"
#include "support/Scenes.hpp"

namespace mpm::solver {
namespace {

using basis::KnotLines;
using grid::Wall;
using material::StateRole;

/// A law with any state; it does nothing.
class Keeper : public material::LinearElastic {
 public:
  Keeper(std::string name, std::vector<material::StateVariable> variables)
      : LinearElastic(test::soft), m_name(std::move(name)), m_variables(std::move(variables)) {}
  std::string_view name() const override { return m_name; }
  std::span<const material::StateVariable> state_variables() const override { return m_variables; }

 private:
  std::string m_name;
  std::vector<material::StateVariable> m_variables;
};

/// Two laws that share the variable "looseness".
particles::Materials softening_laws() {
  const material::StateVariable looseness{"looseness", "looseness", "1", 0.6, StateRole::softening};
  return {std::make_shared<Keeper>("sand",
                                   std::vector<material::StateVariable>{
                                       looseness,
                                       {"age", "age", "s", 3.0},
                                       {"wear", "wear", "m", 0.02, StateRole::softening}}),
          std::make_shared<Keeper>("silt", std::vector<material::StateVariable>{looseness})};
}

template <int dim>
using Lines = std::array<KnotLines, dim>;
template <int dim>
using Kinds = typename grid::Walls<dim>::Kinds;
template <int dim>
using Field = std::function<double(const Vector<dim>&)>;

template <int dim>
Lines<dim> lines() {
  if constexpr (dim == 1) return {test::graded_lines(17)};
  if constexpr (dim == 2) return {test::graded_lines(12), KnotLines::uniform(-1.3, 2.9, 15)};
  if constexpr (dim == 3)
    return {test::graded_lines(9), KnotLines::uniform(-0.7, 1.9, 8), test::graded_lines(11)};
}

/// The largest of three directions that the lines above allow between walls.
constexpr double L = 0.65;

/// A grid full of particles of the softening laws, the second one beyond x = 2.1 m.
template <int dim>
struct Body {
  Body(const Lines<dim>& lines, const Kinds<dim>& walls, const RegularisationOptions& options)
      : nodes(test::node_lines<dim>(test::splines<dim>(lines))),
        grid(test::world(), nodes, test::uneven_layout<dim>(nodes)),
        particles(grid, softening_laws(), {.softening_before = true}) {
    const particles::Filling<dim> filling{[](const Vector<dim>& x) { return x[0] < 2.1 ? 0 : 1; },
                                          [](const auto&) { return 2; }};
    std::vector<particles::Seed<dim>> seeds;
    grid.owned_cells().for_each([&](const auto& cell) {
      const auto more = particles::seeds_of_cell<dim>(lines, cell, filling);
      seeds.insert(seeds.end(), more.begin(), more.end());
    });
    particles.add(seeds);
    regularisation.emplace(options, lines, walls, particles);
  }

  /// Adds to a state of all particles whose law has it.
  void add(const std::string& state, const Field<dim>& increment) {
    const auto view = particles.view();
    const auto handle = particles.fields().handle(state);
    for (int p = 0; p < view.count; ++p)
      if (state != "wear" || view.material[p] == 0)
        view[handle][p] += increment(view.position_of(p));
  }
  void step(const std::string& state, const Field<dim>& increment) {
    regularisation->begin_step();
    add(state, increment);
    regularisation->end_step();
  }

  struct Value {
    std::int64_t id;
    Vector<dim> x;
    double volume, value;
  };
  /// Of all ranks, by id. Collective.
  std::vector<Value> values(const std::string& state) const {
    std::vector<Value> mine;
    {
      const auto view = particles.view();
      const auto handle = particles.fields().handle(state);
      for (int p = 0; p < view.count; ++p)
        mine.push_back({view.id[p], view.position_of(p), view.volume[p], view[handle][p]});
    }
    std::vector<Value> all = test::of_all_ranks(mine, test::world());
    std::ranges::sort(all, {}, &Value::id);
    return all;
  }

  std::array<basis::NodeLine, dim> nodes;
  grid::Grid<dim> grid;
  particles::Particles<dim> particles;
  std::optional<Regularisation<dim>> regularisation;
};

template <int dim>
double rough(const Vector<dim>& x) {
  double value = 0.3;
  for (int d = 0; d < dim; ++d) value += std::sin(17.0 * x[d] + d) + 0.2 * x[d];
  return 1e-3 * value;
}

/// sum of V x of a state.
template <int dim>
double integral(const Body<dim>& body, const std::string& state) {
  double sum = 0.0;
  for (const auto& p : body.values(state)) sum += p.volume * p.value;
  return sum;
}

template <int dim>
double scatter(const Body<dim>& body, const std::string& state) {
  double mean = 0.0, squares = 0.0;
  const auto all = body.values(state);
  for (const auto& p : all) mean += p.value / static_cast<double>(all.size());
  for (const auto& p : all) squares += (p.value - mean) * (p.value - mean);
  return std::sqrt(squares / static_cast<double>(all.size()));
}

template <int dim>
void expect_constant_kept(Wall wall) {
  Body<dim> body(lines<dim>(), test::walls_all<dim>(wall), {.length = L, .every = 1});
  for (int k = 0; k < 3; ++k) body.step("looseness", [](const auto&) { return 0.013; });
  for (const auto& p : body.values("looseness")) EXPECT_NEAR(p.value, 0.6 + 3 * 0.013, 1e-14);
}

TEST(Regularisation, keeps_a_constant_increment_at_walls_and_away_from_them) {
  for (const Wall wall : {Wall::free, Wall::roller, Wall::symmetry, Wall::fixed}) {
    expect_constant_kept<1>(wall);
    expect_constant_kept<2>(wall);
    expect_constant_kept<3>(wall);
  }
}

template <int dim>
void expect_integral_kept(Wall wall) {
  Body<dim> body(lines<dim>(), test::walls_all<dim>(wall), {.length = L, .every = 1});
  for (const std::string state : {"looseness", "wear"}) {
    body.regularisation->begin_step();
    body.add(state, rough<dim>);
    const double sum = integral(body, state), before = scatter(body, state);
    body.regularisation->end_step();
    EXPECT_NEAR(integral(body, state) / sum, 1.0, 1e-14) << state;
    if (state == "looseness") {
      EXPECT_LT(scatter(body, state), 0.5 * before);
    }
  }
}

TEST(Regularisation, keeps_the_integral_over_the_volume_and_takes_out_what_is_shorter) {
  for (const Wall wall : {Wall::free, Wall::roller}) {
    expect_integral_kept<1>(wall);
    expect_integral_kept<2>(wall);
    expect_integral_kept<3>(wall);
  }
}

TEST(Regularisation, leaves_states_alone_that_do_not_soften_and_laws_that_do_not_have_them) {
  Body<2> body(lines<2>(), test::walls_all<2>(Wall::roller), {.length = L, .every = 1});
  body.step("wear", [](const auto&) { return 0.007; });
  for (const auto& p : body.values("wear")) EXPECT_NEAR(p.value, p.x[0] < 2.1 ? 0.027 : 0.0, 1e-15);
  body.step("age", [](const Vector<2>& x) { return x[0] < 2.1 ? x[1] : 0.0; });
  for (const auto& p : body.values("age")) EXPECT_EQ(p.value, p.x[0] < 2.1 ? 3.0 + p.x[1] : 0.0);
}

/// Mean and standard deviation along x of what a spike of two cells about x = 1.2 m becomes, and
/// the profile at places that all grids share.
struct Profile {
  explicit Profile(int cells, double length) {
    const double h = 2.4 / cells;
    Body<2> body({KnotLines::uniform(0.0, 2.4, cells), KnotLines::uniform(0.0, 1.2, cells / 2)},
                 test::walls_all<2>(Wall::roller), {.length = length, .every = 1});
    body.step("looseness",
              [&](const Vector<2>& x) { return std::abs(x[0] - 1.2) < h ? 0.5 / h : 0.0; });
    double sum = 0.0, moment = 0.0;
    for (const auto& p : body.values("looseness")) {
      const double share = (p.value - 0.6) * p.volume / 1.2;
      sum += share;
      mean += share * p.x[0];
      moment += share * p.x[0] * p.x[0];
      peak = std::max(peak, p.value - 0.6);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    deviation = std::sqrt(moment - mean * mean);
  }
  double mean = 0.0, deviation = 0.0, peak = 0.0;
};

TEST(Regularisation, spreads_a_spike_over_the_length_whatever_the_cells) {
  for (const double length : {0.15, 0.2, 0.3}) {
    for (const int cells : {48, 96}) {
      const Profile profile(cells, length);
      EXPECT_NEAR(profile.mean, 1.2, 1e-12);
      EXPECT_NEAR(profile.deviation / (std::sqrt(2.0 / 3.0) * length), 1.0, 0.04);
    }
    EXPECT_NEAR(Profile(48, length).peak / Profile(96, length).peak, 1.0, 0.03);
  }
}

TEST(Regularisation, of_a_half_with_a_wall_of_symmetry_is_that_of_the_whole) {
  const auto even = [](const Vector<2>& x) { return rough<2>({std::abs(x[0]), x[1]}); };
  for (const Wall end : {Wall::free, Wall::roller}) {
    const RegularisationOptions options{.length = 0.4, .every = 1};
    const KnotLines y = KnotLines::uniform(0.0, 1.8, 12);
    Body<2> half({KnotLines::uniform(0.0, 1.8, 12), y}, {{{Wall::symmetry, end}, {end, end}}},
                 options);
    Body<2> whole({KnotLines::uniform(-1.8, 1.8, 24), y}, {{{end, end}, {end, end}}}, options);
    half.step("looseness", even);
    whole.step("looseness", even);
    const auto of_whole = whole.values("looseness");
    for (const auto& p : half.values("looseness")) {
      int found = 0;
      for (const auto& q : of_whole)
        if (std::hypot(std::abs(q.x[0]) - p.x[0], q.x[1] - p.x[1]) < 1e-9) {
          EXPECT_NEAR(q.value, p.value, 1e-14);
          ++found;
        }
      EXPECT_EQ(found, 2);
    }
  }
}

TEST(Regularisation, averages_the_increments_since_the_last_time_only) {
  Body<1> once(lines<1>(), test::walls_all<1>(Wall::roller), {.length = L, .every = 1});
  Body<1> third(lines<1>(), test::walls_all<1>(Wall::roller), {.length = L, .every = 3});
  third.add("looseness", rough<1>);  // before the first interval: no increment
  const auto given = third.values("looseness");
  for (int k = 0; k < 2; ++k) third.step("looseness", rough<1>);
  const auto waiting = third.values("looseness");
  for (std::size_t p = 0; p < given.size(); ++p)
    EXPECT_NEAR(waiting[p].value, given[p].value + 2.0 * rough<1>(given[p].x), 1e-15);
  third.step("looseness", rough<1>);
  once.step("looseness", [](const Vector<1>& x) { return 3.0 * rough<1>(x); });
  const auto expected = once.values("looseness"), averaged = third.values("looseness");
  for (std::size_t p = 0; p < given.size(); ++p)
    EXPECT_NEAR(averaged[p].value - given[p].value, expected[p].value - 0.6, 1e-15);
}

TEST(Regularisation, goes_on_where_it_was_saved) {
  Body<1> body(lines<1>(), test::walls_all<1>(Wall::roller), {.length = L, .every = 3});
  body.step("looseness", rough<1>);
  Archive taken;
  body.regularisation->persist(taken);
  Archive given(taken.values());
  body.regularisation.emplace(RegularisationOptions{.length = L, .every = 3}, lines<1>(),
                              test::walls_all<1>(Wall::roller), body.particles);
  body.regularisation->persist(given);
  for (int k = 0; k < 2; ++k) body.step("looseness", rough<1>);
  Body<1> other(lines<1>(), test::walls_all<1>(Wall::roller), {.length = L, .every = 3});
  for (int k = 0; k < 3; ++k) other.step("looseness", rough<1>);
  const auto a = body.values("looseness"), b = other.values("looseness");
  for (std::size_t p = 0; p < a.size(); ++p) EXPECT_EQ(a[p].value, b[p].value);
}

// In a simulation of sand -------------------------------------------------------------------------

SimulationSetup<2> sand_box(const RegularisationOptions& options) {
  auto setup = test::full_box<2>(
      {KnotLines::uniform(0.0, 2.1, 14), KnotLines::uniform(0.0, 1.8, 12)}, Wall::roller);
  material::SandParameters sand;
  sand.void_ratio = 0.57;
  setup.materials = {std::make_shared<material::SandLaw>(sand)};
  setup.regularisation = options;
  return setup;
}

Vector<2> rough_motion(const Vector<2>& x) {
  return {0.9 * std::sin(11.0 * x[0]) * std::cos(3.0 * x[1]), 0.7 * std::cos(13.0 * x[1] * x[0])};
}

struct Grain {
  std::int64_t id;
  double volume, void_ratio, eps_q;

  bool operator==(const Grain&) const = default;
};

/// By id, after some steps from 80 kPa.
std::vector<Grain> after(const RegularisationOptions& options, int steps) {
  test::TimedSimulation<2> simulation(sand_box(options));
  test::set_stress<2>(simulation, {{-8e4, -8e4, -8e4, 0, 0, 0}});
  test::set_velocity<2>(simulation, rough_motion);
  test::run_steps(simulation, steps, 1e-4);
  const auto& particles = simulation.particles();
  std::vector<Grain> mine;
  {
    const auto view = particles.view();
    const auto e = particles.state(0, "void_ratio"), eps_q = particles.state(0, "eps_q");
    for (int p = 0; p < view.count; ++p)
      mine.push_back({view.id[p], view.volume[p], view[e][p], view[eps_q][p]});
  }
  auto all = test::of_all_ranks(mine, test::world());
  std::ranges::sort(all, {}, &Grain::id);
  return all;
}

TEST(RegularisedSand, has_the_mean_void_ratio_and_strain_of_sand_that_is_not) {
  const auto plain = after({}, 1), averaged = after({.length = 0.45, .every = 1}, 1);
  double e = 0.0, eps_q = 0.0, e_plain = 0.0, eps_q_plain = 0.0, difference = 0.0;
  for (std::size_t p = 0; p < plain.size(); ++p) {
    ASSERT_EQ(plain[p].volume, averaged[p].volume);
    e_plain += plain[p].volume * plain[p].void_ratio;
    e += averaged[p].volume * averaged[p].void_ratio;
    eps_q_plain += plain[p].volume * plain[p].eps_q;
    eps_q += averaged[p].volume * averaged[p].eps_q;
    difference = std::max(difference, std::abs(averaged[p].eps_q - plain[p].eps_q));
  }
  ASSERT_GT(difference, 1e-6);
  EXPECT_NEAR(e / e_plain, 1.0, 1e-14);
  EXPECT_NEAR(eps_q / eps_q_plain, 1.0, 1e-12);
}

TEST(RegularisedSand, is_the_same_on_all_ranks) {
  const RegularisationOptions options{.length = 0.45, .every = 7};
  const auto shared = after(options, 100);
  EXPECT_EQ(shared, after(options, 100));
  const test::SerialWorld alone;
  const auto serial = after(options, 100);
  ASSERT_EQ(shared.size(), serial.size());
  for (std::size_t p = 0; p < serial.size(); ++p) {
    EXPECT_NEAR(shared[p].void_ratio, serial[p].void_ratio, 1e-9);
    EXPECT_NEAR(shared[p].eps_q, serial[p].eps_q, 1e-9);
  }
}

// Refusals ---------------------------------------------------------------------------------------

void expect_refused(const SimulationSetup<2>& setup, const std::vector<std::string>& words) {
  try {
    const Simulation<2> simulation(setup);
    FAIL() << "was taken";
  } catch (const BadInput& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(Regularisation, refuses_lengths_that_do_nothing_or_too_much_and_laws_without_softening) {
  expect_refused(sand_box({.length = 0.28}), {"-regularisation_length 0.28", "at least 0.3 m"});
  expect_refused(sand_box({.length = 0.8}), {"-regularisation_length 0.8", "at most"});
  auto elastic = sand_box({.length = 0.45});
  elastic.materials = {test::elastic()};
  expect_refused(elastic, {"-regularisation_length 0.45", "no law"});
}

TEST(AveragingLines, have_the_length_where_no_two_walls_forbid_it) {
  const KnotLines lines = KnotLines::uniform(-0.5, 1.6, 14);
  const auto width = [&](Wall first, Wall last) {
    return averaging_lines(lines, {first, last}, 0.4).width(1);
  };
  EXPECT_NEAR(width(Wall::free, Wall::free), 0.4, 1e-15);
  EXPECT_NEAR(width(Wall::fixed, Wall::free), 0.4, 1e-15);
  EXPECT_NEAR(width(Wall::free, Wall::roller), 0.4, 1e-15);
  EXPECT_NEAR(width(Wall::symmetry, Wall::roller), 2.1 / 5, 1e-15);
  EXPECT_EQ(averaging_lines(lines, {Wall::fixed, Wall::free}, 0.4).begin(), -0.5);
  EXPECT_NEAR(averaging_lines(lines, {Wall::free, Wall::roller}, 0.4).end(), 1.6, 1e-15);
}

}  // namespace
}  // namespace mpm::solver
