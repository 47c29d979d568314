#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/run/Endings.hpp"
#include "mpm/run/History.hpp"
#include "mpm/run/Run.hpp"
#include "support/Scenes.hpp"
#include "support/SharedDirectory.hpp"

namespace mpm::run {
namespace {

using PlaneRun = Run<2>;  // tests have a member of the name Run

constexpr double dt = 1e-4;  // s

/// Remembers at what times it was asked.
struct Recorded : contact::Motion<2> {
  contact::BodyVelocity<2> at(double time) const override {
    times.push_back(time);
    return {{0.0, -0.3}, 0.0};
  }
  mutable std::vector<double> times;
};

/// A box that settles for three steps and is then sheared for seven, the last of them shorter.
struct Sheared {
  explicit Sheared(const std::string& directory) {
    options.output_dir = directory;
    options.progress = ProgressDisplay::off;
  }

  Problem<2> problem() {
    Problem<2> problem{.setup =
                           test::full_box<2>(test::equal_lines<2>(0.0, 1.2, 8), grid::Wall::fixed)};
    problem.arrange = [](solver::Simulation<2>& simulation) {
      test::set_velocity<2>(simulation, [](const Vector<2>& x) {
        return Vector<2>{0.2 * x[0] * (1.2 - x[0]), 0.0};
      });
    };
    motion = std::make_shared<Recorded>();
    body = std::make_shared<contact::RigidBody<2>>(std::make_shared<geometry::Ball<2>>(0.2),
                                                   Vector<2>{0.5, 2.0}, motion);
    history = std::make_shared<History<2>>(HistoryTable<2>{
        .path = options.output_dir + "/history.csv",
        .columns = {"time_s"},
        .row = [](const Moment<2>& now) { return std::vector<double>{now.clock.time}; },
        .cadence = Cadence<2>(2)});
    problem.bodies = {body};
    problem.stages = {{.name = "settling",
                       .ending = std::make_shared<AfterSteps<2>>(3),
                       .is_main = false,
                       .holds_bodies = true,
                       .longest_step = dt},
                      {.name = "shearing",
                       .ending = std::make_shared<AfterTime<2>>(6.5 * dt),
                       .begins_anew = true,
                       .longest_step = dt}};
    problem.observers = {history};
    problem.writes_fields_at_start = true;
    return problem;
  }

  RunOptions options;
  std::shared_ptr<Recorded> motion;
  std::shared_ptr<contact::RigidBody<2>> body;
  std::shared_ptr<History<2>> history;
};

/// The times in an XDMF file.
std::vector<double> times_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  std::vector<double> times;
  const std::string mark = "<Time Value=\"";
  for (std::size_t at = 0; (at = text.str().find(mark, at)) != std::string::npos; ++at)
    times.push_back(std::stod(text.str().substr(at + mark.size())));
  return times;
}

TEST(Run, evaluates_motions_in_the_middle_of_the_steps_that_are_taken) {
  const test::SharedDirectory directory;
  Sheared sheared(directory.path());
  PlaneRun run(sheared.options, sheared.problem());
  run.go();
  ASSERT_EQ(sheared.motion->times.size(), 7u);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(sheared.motion->times[k], (static_cast<double>(k) + 0.5) * dt, 1e-12 * dt);
  EXPECT_NEAR(sheared.motion->times[6], 6.25 * dt, 1e-9 * dt);  // the last step is half as long
  EXPECT_NEAR(sheared.body->position[1], 2.0 - 0.3 * 6.5 * dt, 1e-14);
  EXPECT_EQ(run.clock().step, 10);
  EXPECT_NEAR(run.clock().time, 6.5 * dt, 1e-15);
}

TEST(Run, limits_count_from_the_beginning_of_the_main_stage) {
  const test::SharedDirectory directory;
  Sheared sheared(directory.path());
  sheared.options.max_steps = 2;
  PlaneRun run(sheared.options, sheared.problem());
  run.go();
  EXPECT_EQ(run.clock().step, 5);
  EXPECT_EQ(run.clock().counted_steps, 2);
}

TEST(Run, limits_count_in_the_stage_that_is_named) {
  const test::SharedDirectory directory;
  Sheared sheared(directory.path());
  sheared.options.max_steps = 2;
  sheared.options.counted_stage = "settling";
  PlaneRun run(sheared.options, sheared.problem());
  run.go();
  EXPECT_EQ(run.clock().step, 2);
  sheared.options.counted_stage = "shaking";
  EXPECT_THROW(PlaneRun(sheared.options, sheared.problem()), BadInput);
}

TEST(Run, writes_every_moment_once_and_times_increase) {
  const test::SharedDirectory directory;
  Sheared sheared(directory.path());
  sheared.options.particle_output_every = 2;
  sheared.options.particle_output_times = {2.5 * dt, 4.0 * dt, 6.5 * dt};
  PlaneRun run(sheared.options, sheared.problem());
  run.go();
  const std::vector<double> times = times_of(directory.path("particles.xdmf"));
  ASSERT_GE(times.size(), 5u);
  EXPECT_EQ(times.front(), 0.0);
  EXPECT_NEAR(times.back(), 6.5 * dt, 1e-15);
  for (std::size_t k = 1; k < times.size(); ++k) EXPECT_GT(times[k], times[k - 1]);
}

TEST(Run, puts_back_what_it_has_saved) {
  const test::SharedDirectory directory;
  Sheared sheared(directory.path());
  PlaneRun run(sheared.options, sheared.problem());
  run.go();
  Archive saved;
  run.persist(saved);
  Sheared other(directory.path());
  PlaneRun fresh(other.options, other.problem());
  Archive given(saved.values());
  fresh.persist(given);
  EXPECT_EQ(fresh.clock().step, 10);
  EXPECT_EQ(other.history->rows(), sheared.history->rows());
  EXPECT_EQ(other.body->position, sheared.body->position);
  Archive again;
  fresh.persist(again);
  EXPECT_EQ(again.values(), saved.values());
}

TEST(Archive, refuses_a_name_that_is_saved_twice_or_was_never_saved) {
  Archive archive;
  double value = 2.5;
  archive("speed", value);
  EXPECT_THROW(archive("speed", value), std::logic_error);
  Archive given(archive.values());
  value = 0.0;
  given("speed", value);
  EXPECT_EQ(value, 2.5);
  EXPECT_THROW(given("spin", value), std::logic_error);
}

}  // namespace
}  // namespace mpm::run
