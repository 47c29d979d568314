#include "mpm/run/Checkpoint.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "mpm/contact/SpringContact.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/io/Hdf5File.hpp"
#include "mpm/io/Hdf5Input.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"
#include "mpm/run/Run.hpp"
#include "mpm/run/Signals.hpp"
#include "support/Scenes.hpp"
#include "support/SharedDirectory.hpp"

namespace mpm::run {
namespace {

using PlaneRun = Run<2>;  // tests have a member of the name Run

constexpr double dt = 1e-4;  // s

/// A block that settles on a plane held by springs, then slides under gravity of another direction.
template <int dim>
struct Sliding {
  Sliding(const std::string& directory, long long checkpoint_every) {
    options.output_dir = directory;
    options.progress = ProgressDisplay::off;
    options.checkpoint.every = checkpoint_every;
    options.particle_output_every = 3;
  }

  Problem<dim> problem() {
    Problem<dim> problem{
        .setup = test::full_box<dim>(test::equal_lines<dim>(0.0, 1.0, 8), grid::Wall::free)};
    problem.setup.filling.material_at = [](const Vector<dim>& x) {
      for (const double c : x)
        if (c < 0.25 || c > 0.75) return std::optional<int>();
      return std::optional<int>(0);
    };
    problem.setup.gravity[dim - 1] = -9.81;
    problem.setup.particle_contacts = {"contact"};
    problem.setup.transfer = solver::Transfer::apic;
    add_plane(problem);
    Vector<dim> tilted{};
    tilted[0] = 3.0;
    tilted[dim - 1] = -9.0;
    problem.stages = {{.name = "settling",
                       .ending = std::make_shared<AfterSteps<dim>>(6),
                       .is_main = false,
                       .damping = 0.3,
                       .longest_step = dt},
                      {.name = "sliding",
                       .ending = std::make_shared<AfterTime<dim>>(11.5 * dt),
                       .begins_anew = true,
                       .longest_step = dt,
                       .gravity = tilted}};
    problem.observers = {std::make_shared<History<dim>>(HistoryTable<dim>{
        .path = options.output_dir + "/history.csv",
        .columns = {"time_s", "kinetic_energy_J"},
        .row =
            [](const Moment<dim>& now) {
              return std::vector<double>{now.clock.time, now.simulation.kinetic_energy()};
            },
        .cadence = Cadence<dim>(2),
        .has_first_row = true,
        .has_ledger = true})};
    return problem;
  }

  static void add_plane(Problem<dim>& problem) {
    Vector<dim> up{}, at{};
    up[dim - 1] = 1.0;
    at[dim - 1] = 0.25;
    const auto plane = std::make_shared<contact::RigidBody<dim>>(
        std::make_shared<geometry::HalfSpace<dim>>(up), at);
    problem.bodies = {plane};
    problem.constraints = {[plane](const solver::Simulation<dim>& simulation) {
      return std::make_shared<contact::SpringContact<dim>>(
          simulation.grid(), simulation.walls(), simulation.step().point_deposit(),
          simulation.particles(), plane,
          contact::ContactOptions{.friction = 0.2, .label = "contact"});
    }};
  }

  RunOptions options;
};

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// All columns of this rank, by name.
template <class Points>
std::map<std::string, std::vector<double>> columns(const Points& points) {
  std::map<std::string, std::vector<double>> all;
  points.for_each_column([&](const std::string& name, auto values) {
    for (const auto value : values) all[name].push_back(static_cast<double>(value));
  });
  return all;
}

template <int dim>
void expect_same_bits(long long checkpoint_every) {
  const test::SharedDirectory whole, broken;
  Sliding<dim> first(whole.path(), 0), second(broken.path(), checkpoint_every);
  Run<dim> uninterrupted(first.options, first.problem());
  uninterrupted.go();
  Run<dim>(second.options, second.problem()).go();
  Sliding<dim> third(broken.path(), 0);
  third.options.checkpoint.restart = restart_if_possible;
  Run<dim> resumed(third.options, third.problem());
  EXPECT_TRUE(resumed.goes_on_in_place());
  EXPECT_LT(resumed.clock().step, uninterrupted.clock().step);
  resumed.go();
  EXPECT_EQ(resumed.clock().step, uninterrupted.clock().step);
  EXPECT_EQ(content(broken.path("history.csv")), content(whole.path("history.csv")));
  EXPECT_EQ(content(broken.path("particles.xdmf")), content(whole.path("particles.xdmf")));
  const auto before = columns(uninterrupted.simulation().particles());
  const auto after = columns(resumed.simulation().particles());
  for (const auto& [name, values] : before)
    for (std::size_t k = 0; k < values.size(); ++k)
      if (!(std::isnan(values[k]) && std::isnan(after.at(name)[k]))) {
        ASSERT_EQ(values[k], after.at(name)[k]) << name << " " << k;
      }
}

TEST(Checkpoint, gives_back_the_bits_in_the_first_stage_and_in_the_second) {
  for (const long long every : {4, 5, 9}) {
    SCOPED_TRACE(every);
    expect_same_bits<2>(every);
  }
}

TEST(Checkpoint, gives_back_the_bits_in_one_and_in_three_dimensions) {
  if (test::world_size() == 1) expect_same_bits<1>(9);
  if (test::world_size() <= 2) expect_same_bits<3>(9);
}

/// Whatever the table of fields calls a state has to be in the file, and nothing that it derives.
TEST(Checkpoint, has_every_field_that_is_a_state) {
  const test::SharedDirectory directory;
  Sliding<2> sliding(directory.path(), 5);
  PlaneRun run(sliding.options, sliding.problem());
  run.go();
  const io::Hdf5Input file(checkpoint_path(directory.path()));
  const auto count = run.simulation().particles().global_count();
  std::set<std::string> names{particles::id_column};
  for (const auto& column : run.simulation().particles().fields().columns())
    names.insert(column.name);
  for (const std::string& name : names) EXPECT_EQ(file.size("particles/" + name), count) << name;
  for (const auto& field : run.simulation().particles().fields().all())
    if (field.role == particles::Role::derived) {
      EXPECT_THROW(file.size("particles/" + field.name), std::runtime_error);
    }
}

TEST(Checkpoint, is_refused_where_it_is_of_another_problem_or_none) {
  const test::SharedDirectory directory;
  Sliding<2> sliding(directory.path(), 5);
  PlaneRun(sliding.options, sliding.problem()).go();
  const auto refused = [&](const std::string& name, const std::string& fault) {
    try {
      const Checkpoint checkpoint(directory.path(name), test::world());
      checkpoint.check({"pipe", {}});
    } catch (const BadInput& error) {
      EXPECT_NE(std::string(error.what()).find(fault), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      return true;
    }
    return false;
  };
  EXPECT_TRUE(refused("checkpoint.h5", "-scene pipe"));
  EXPECT_TRUE(refused("none.h5", "No such file"));
  EXPECT_TRUE(refused("particles_000000.h5", "no checkpoint"));
  EXPECT_TRUE(refused("history.csv", "no HDF5"));
  if (test::world_rank() == 0)
    std::filesystem::resize_file(directory.path("checkpoint.h5"), 20'000);
  test::world().barrier();
  EXPECT_TRUE(refused("checkpoint.h5", "cut off"));
  {
    io::Hdf5File file(directory.path("later.h5"), test::world());
    file.attribute("mpmsolve_checkpoint", std::int64_t{1'000'000});
    file.close();
  }
  EXPECT_TRUE(refused("later.h5", "format 1000000"));
}

TEST(Checkpoint, refuses_options_that_contradict_it_and_lets_ends_and_outputs_change) {
  const test::SharedDirectory directory;
  Sliding<2> sliding(directory.path(), 5);
  const PlaneRun run(sliding.options, sliding.problem());
  const std::string path = directory.path("some.h5");
  write_checkpoint<2>(path, {"slide", {{"courant", "0.3"}, {"max_steps", "7"}}}, {1, dt},
                      run.simulation(), {});
  const Checkpoint checkpoint(path, test::world());
  EXPECT_NO_THROW(checkpoint.check({"slide", {{"courant", "0.3"}, {"max_steps", "70"}}}));
  try {
    checkpoint.check({"slide", {{"courant", "0.4"}}});
    FAIL();
  } catch (const BadInput& error) {
    for (const char* word : {"-courant 0.3", "-courant 0.4", "-max_steps", "some.h5"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

/// Shares of sums are added up, and what only one rank can use is left alone.
TEST(Checkpoint, joins_what_ranks_had_where_there_are_other_ranks) {
  const test::SharedDirectory directory;
  Sliding<2> sliding(directory.path(), 5);
  PlaneRun(sliding.options, sliding.problem()).go();
  const Checkpoint all(checkpoint_path(directory.path()), test::world());
  const Checkpoint alone(checkpoint_path(directory.path()), MPI_COMM_SELF);
  const Archive here = all.archive(), there = alone.archive();
  for (const auto& [name, entry] : here.values()) {
    const auto& joined = there.values().at(name);
    if (entry.kind == Archive::Kind::shared) {
      EXPECT_EQ(joined, entry) << name;
    }
    if (entry.kind != Archive::Kind::sum) continue;
    for (std::size_t k = 0; k < entry.values.size(); ++k) {
      const double sum = test::world().sum(entry.values[k]);
      EXPECT_NEAR(joined.values[k], sum, 1e-12 * (1.0 + std::abs(sum))) << name;
    }
  }
}

TEST(Checkpoint, names_what_ranks_should_have_alike_and_have_not) {
  if (test::world_size() == 1) return;
  const test::SharedDirectory directory;
  Sliding<2> sliding(directory.path(), 5);
  const PlaneRun run(sliding.options, sliding.problem());
  Archive archive;
  double speed = test::world_rank();
  archive("speed", speed);
  try {
    write_checkpoint<2>(directory.path("some.h5"), {}, {}, run.simulation(), archive);
    FAIL();
  } catch (const NumericalFailure& error) {
    EXPECT_NE(std::string(error.what()).find("'speed'"), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(directory.path("some.h5")));
}

/// One rank is asked; all stop together, and what is left goes on.
TEST(Signals, at_one_rank_end_the_run_of_all_with_a_checkpoint) {
  const test::SharedDirectory directory;
  const SignalHandlers handlers;
  Sliding<2> sliding(directory.path(), 0);
  PlaneRun run(sliding.options, sliding.problem());
  if (test::world_rank() == test::world_size() - 1) std::raise(SIGTERM);
  EXPECT_THROW(run.go(), StoppedEarly);
  EXPECT_EQ(run.clock().step, 1);
  forget_signals();
  sliding.options.checkpoint.restart = restart_if_possible;
  PlaneRun resumed(sliding.options, sliding.problem());
  EXPECT_EQ(resumed.clock().step, 1);
  std::raise(SIGUSR1);
  std::filesystem::remove(directory.path("checkpoint.h5"));
  test::world().barrier();
  EXPECT_NO_THROW(resumed.go());
  EXPECT_TRUE(std::filesystem::exists(directory.path("checkpoint.h5")));
}

}  // namespace
}  // namespace mpm::run
