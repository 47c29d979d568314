#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "ElasticBlock.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/petsc/Session.hpp"

// What two ranks pay to exchange: messages to and fro, an Allreduce of one number, and the halo of
// nodal fields on the grids of runs. Prints CSV, medians in microseconds.

namespace mpm {
namespace {

constexpr int repetitions = 25;

/// Median time of one call in microseconds, the slower rank's. Collective.
double microseconds(int calls, const std::function<void()>& call) {
  std::vector<double> times;
  for (int k = 0; k <= repetitions; ++k) {
    MPI_Barrier(petsc::world());
    const double begin = MPI_Wtime();
    for (int i = 0; i < calls; ++i) call();
    times.push_back(1e6 * petsc::maximum(MPI_Wtime() - begin) / calls);
  }
  times.erase(times.begin());  // warms up
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

void print(const std::string& measure, long long bytes, double time) {
  if (petsc::world_rank() == 0) fmt::print("{},{},{:.4g}\n", measure, bytes, time);
}

/// One way: half of to and fro.
void measure_messages(int bytes) {
  std::vector<char> data(static_cast<std::size_t>(bytes));
  const int rank = petsc::world_rank(), other = 1 - rank;
  const auto send = [&] { MPI_Send(data.data(), bytes, MPI_CHAR, other, 0, petsc::world()); };
  const auto receive = [&] {
    MPI_Recv(data.data(), bytes, MPI_CHAR, other, 0, petsc::world(), MPI_STATUS_IGNORE);
  };
  const double both = microseconds(bytes > 100'000 ? 20 : 200, [&] {
    if (rank == 0) send();
    receive();
    if (rank == 1) send();
  });
  print("message", bytes, 0.5 * both);
}

void measure_allreduce() {
  int number = 1;
  const double time = microseconds(
      200, [&] { MPI_Allreduce(MPI_IN_PLACE, &number, 1, MPI_INT, MPI_MAX, petsc::world()); });
  print("allreduce", sizeof(int), time);
}

/// Bytes are those that a rank sends, all components together.
template <int dim>
void measure_halo(const grid::Grid<dim>& grid, int components) {
  grid::NodalField<dim> field(grid,
                              std::vector<grid::Component>(static_cast<std::size_t>(components)));
  field.set_to_zero();
  long long ghosts = 0;
  grid.for_each_local_node([&](int, const auto&) { ++ghosts; });
  grid.for_each_owned_node([&](int, const auto&) { --ghosts; });
  const auto of_a_node = static_cast<long long>(sizeof(double)) * components;
  const auto bytes =
      static_cast<long long>(petsc::maximum(static_cast<double>(ghosts * of_a_node)));
  print(fmt::format("halo_sum_{}d", dim), bytes, microseconds(20, [&] { field.sum_to_owners(); }));
  print(fmt::format("halo_copy_{}d", dim), bytes,
        microseconds(20, [&] { field.copy_to_ghosts(); }));
}

template <int dim>
void measure_halos(int cells) {
  const auto simulation = bench::make_elastic_block<dim>({.cells = cells});
  for (int components : {dim, 2 * dim, 2 * dim + 1}) measure_halo(simulation->grid(), components);
}

void measure_all() {
  if (petsc::world_rank() == 0) fmt::print("measure,bytes,microseconds\n");
  for (int bytes : {8, 64, 512, 4096, 32'768, 262'144, 2'097'152}) measure_messages(bytes);
  measure_allreduce();
  measure_halos<2>(106);
  measure_halos<2>(500);
  measure_halos<3>(19);
}

}  // namespace
}  // namespace mpm

int main() {
  const mpm::petsc::Session session;
  if (mpm::petsc::world_size() != 2) {
    if (session.rank() == 0) fmt::print(stderr, "exchange needs two ranks\n");
    return 2;
  }
  mpm::measure_all();
}
