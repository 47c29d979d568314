#include <gtest/gtest.h>

#include <utility>

#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/core/Errors.hpp"
#include "support/Scenes.hpp"

namespace mpm::test {
namespace {

using Result = std::vector<Snapshot<2>>;

/// The world cut in two: the first `first` ranks and the others, counted from either end.
class Half {
 public:
  enum class CountedFrom { front, back };

  explicit Half(CountedFrom end) {
    const int rank = end == CountedFrom::front ? world_rank() : world_size() - 1 - world_rank();
    is_first = rank < world_size() / 2;
    MPI_Comm_split(world(), is_first ? 0 : 1, world_rank(), &m_communicator);
  }
  ~Half() { MPI_Comm_free(&m_communicator); }
  Half(const Half&) = delete;
  Half& operator=(const Half&) = delete;

  petsc::Communicator ranks() const { return m_communicator; }
  bool is_first;  ///< this rank belongs to the first half

 private:
  MPI_Comm m_communicator = MPI_COMM_NULL;
};

/// A block that falls on a rigid plane and has reached it.
Result fall(const petsc::Communicator& ranks) {
  auto setup = full_box<2>(equal_lines<2>(0.0, 1.2, 12), grid::Wall::free);
  setup.communicator = ranks;
  setup.gravity = {0.7, -9.3};
  setup.flip_time = 0.02;
  setup.filling.material_at = [](const Vector<2>& x) {
    const bool inside = std::abs(x[0] - 0.6) < 0.2 && std::abs(x[1] - 0.65) < 0.25;
    return inside ? std::optional(0) : std::nullopt;
  };
  TimedSimulation<2> block(setup);
  const auto ground = cases::ground(0.37);
  block.add_constraint(
      cases::contact_of(block, ground, {.friction = 0.3, .reference_density = soft.density}));
  run_steps<2>(block, 90, 2e-3);
  EXPECT_GT(std::abs(ranks.sum(ground->meter().take_impulse()[1])), 1.0);
  return snapshots<2>(block.particles());
}

/// A box that shakes, by another basis and update.
Result shake(const petsc::Communicator& ranks) {
  auto setup = full_box<2>(equal_lines<2>(0.0, 0.9, 11), grid::Wall::fixed, 3);
  setup.communicator = ranks;
  setup.basis = basis::Kind::quadratic;
  setup.scheme = solver::Scheme::usl;
  setup.courant = 0.4;
  TimedSimulation<2> box(setup);
  set_velocity<2>(box, [](const Vector<2>& x) {
    return Vector<2>{0.6 * x[1] * (0.9 - x[0]), -0.4 * x[0] * x[1]};
  });
  run_steps<2>(box, 130, 1e-2);
  return snapshots<2>(box.particles());
}

/// A box that flies out of the grid.
Result leave(const petsc::Communicator& ranks) {
  auto setup = full_box<2>(equal_lines<2>(0.0, 1.1, 9), grid::Wall::free);
  setup.communicator = ranks;
  TimedSimulation<2> box(setup);
  set_velocity<2>(box, [](const Vector<2>&) { return Vector<2>{3.0, 1.7}; });
  run_steps<2>(box, 200, 1e-2);
  return snapshots<2>(box.particles());
}

/// What one half has found, on all ranks of the world.
Result known_to_all(const Half& half, bool of_first, const Result& mine) {
  const bool gives = half.is_first == of_first && half.ranks().is_root();
  return of_all_ranks(gives ? mine : Result{});
}

/// Of a simulation on as many ranks as the half has, but on other ones, while nobody else computes.
Result alone(bool on_first, Result (*simulate)(const petsc::Communicator&)) {
  const Half half(Half::CountedFrom::back);
  Result mine;
  if (half.is_first == on_first) mine = simulate(half.ranks());
  return known_to_all(half, on_first, mine);
}

TEST(Communicator, halves_of_the_world_find_at_the_same_time_what_each_finds_alone) {
  if (world_size() < 2) GTEST_SKIP() << "two halves need two ranks";
  const Half half(Half::CountedFrom::front);
  const Result mine = half.is_first ? fall(half.ranks()) : shake(half.ranks());
  const Result fallen = known_to_all(half, true, mine), shaken = known_to_all(half, false, mine);
  ASSERT_FALSE(fallen.empty());
  ASSERT_FALSE(shaken.empty());
  EXPECT_TRUE(fallen == alone(true, fall));
  EXPECT_TRUE(shaken == alone(false, shake));
}

TEST(Communicator, a_failure_in_one_half_is_thrown_on_its_ranks_only) {
  if (world_size() < 2) GTEST_SKIP() << "two halves need two ranks";
  const Half half(Half::CountedFrom::front);
  Result mine;
  if (half.is_first) {
    EXPECT_THROW(leave(half.ranks()), NumericalFailure);
  } else {
    mine = shake(half.ranks());
  }
  EXPECT_TRUE(known_to_all(half, false, mine) == alone(false, shake));
}

}  // namespace
}  // namespace mpm::test
