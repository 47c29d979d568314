// An elastic block falls on a rigid plane and bounces. Exact: in flight it falls by g t^2/2, and
// what the plane gives is the change of the block's momentum and m g t.
#include <cstdio>

#include "mpm/cases/RigidContactOf.hpp"
#include "mpm/material/LinearElastic.hpp"

using namespace mpm;

constexpr double g = 9.81, density = 1900.0, dt = 1e-4;  // m/s^2, kg/m^3, s
constexpr double side = 0.5, plane = 0.42, start = 0.9;  // m; start and plane are heights

solver::SimulationSetup<2> block_above_plane(MPI_Comm ranks) {
  solver::SimulationSetup<2> setup{
      .lines = {basis::KnotLines::uniform(0.0, 1.0, 20), basis::KnotLines::uniform(0.0, 1.4, 28)}};
  setup.communicator = ranks;
  setup.materials = {std::make_shared<material::LinearElastic>(material::LinearElasticParameters{
      .youngs_modulus = 2e7, .poisson_ratio = 0.3, .density = density})};
  setup.filling.material_at = [](const Vector<2>& x) {
    const double distance = std::max(std::abs(x[0] - 0.5), std::abs(x[1] - start));
    return distance < 0.5 * side ? std::optional(0) : std::nullopt;
  };
  setup.filling.per_direction = [](const Vector<2>&) { return 2; };
  setup.gravity = {0.0, -g};
  setup.flip_time = 1e-3;  // s: damps what particles have and the grid cannot see
  return setup;
}

void run_until(double end, solver::Simulation<2>& block) {
  for (double time = dt * static_cast<double>(block.steps()); time < end - 0.5 * dt; time += dt)
    block.advance(time, block.plan(dt));
}

double mean_height(const solver::Simulation<2>& block) {  // all particles have the same mass
  const auto view = block.particles().view();
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) sum += view.position[1][p];
  return block.communicator().sum(sum) / static_cast<double>(block.particles().global_count());
}

bool agree(const char* what, double value, double exact) {
  if (petsc::is_root()) std::printf("%s %.10g, exact %.10g\n", what, value, exact);
  return std::abs(value / exact - 1.0) < 1e-9;
}

int main() {
  const petsc::Session session;  // starts MPI and PETSc unless they run
  solver::Simulation<2> block(block_above_plane(MPI_COMM_WORLD));
  const auto ground = cases::ground(plane);
  block.add_constraint(cases::contact_of(
      block, ground,
      {.detection = contact::detection_named("particle"), .reference_density = density}));

  run_until(0.2, block);
  bool right = agree("height in flight, m:", mean_height(block), start - 0.5 * g * 0.2 * 0.2);
  run_until(0.4, block);
  // Velocities live at half steps.
  const double given = -block.communicator().sum(ground->meter().take_impulse()[1]);
  const double needed = block.momentum()[1] + block.total_mass() * g * (0.4 - 0.5 * dt);
  right = agree("impulse of the plane, N s/m:", given, needed) && right;
  const double height = mean_height(block);
  return right && height > plane + 0.5 * side && height < start ? 0 : 1;
}
