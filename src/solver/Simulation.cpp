#include "mpm/solver/Simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "mpm/core/Errors.hpp"
#include "mpm/petsc/Log.hpp"
#include "mpm/solver/StableCourant.hpp"

namespace mpm::solver {
namespace {

constexpr int steps_between_renewals = 10;  // of dt
constexpr int steps_between_sorts = 500;    // particles lose their order slowly
constexpr double largest_growth_of_dt = 1.05;
constexpr double smallest_share_of_dt = 1e-4;  // of the first one; less is a collapse

template <int dim>
basis::BasisOptions basis_options(const SimulationSetup<dim>& setup) {
  return {.ends = setup.ends, .particles_per_cell = setup.particles_per_cell};
}

template <int dim, class Basis>
std::array<Basis, dim> bases(const SimulationSetup<dim>& setup) {
  return [&]<std::size_t... d>(std::index_sequence<d...>) {
    return std::array<Basis, dim>{
        basis::make_basis<Basis>(setup.lines[d], basis_options(setup))...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
}

template <int dim>
std::array<basis::NodeLine, dim> node_lines(const SimulationSetup<dim>& setup) {
  return basis::with_basis(setup.basis, [&]<class Basis>() {
    return [&]<std::size_t... d>(std::index_sequence<d...>) {
      return std::array<basis::NodeLine, dim>{
          basis::make_basis<Basis>(setup.lines[d], basis_options(setup)).nodes()...};
    }
    (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
  });
}

/// Particles that each cell is to get; the same on all ranks.
template <int dim>
partition::CellWork<dim> seed_counts(const SimulationSetup<dim>& setup) {
  partition::CellWork<dim> counts;
  for (int d = 0; d < dim; ++d) counts.cells[d] = setup.lines[d].cells();
  partition::for_each_cell<dim>(counts.cells, [&](std::size_t, const std::array<int, dim>& cell) {
    counts.work.push_back(static_cast<double>(
        particles::seeds_of_cell<dim>(setup.lines, cell, setup.filling).size()));
  });
  return counts;
}

}  // namespace

template <int dim>
Simulation<dim>::Simulation(const SimulationSetup<dim>& setup)
    : m_balance(setup.communicator, node_lines(setup), setup.balance),
      m_grid(make_grid(setup)),
      m_walls(setup.walls),
      m_particles(std::make_unique<particles::Particles<dim>>(
          *m_grid, setup.materials,
          particles::OptionalColumns{.velocity_gradient = setup.transfer == Transfer::apic,
                                     .softening_before = setup.regularisation.is_on(),
                                     .contacts = setup.particle_contacts})),
      m_boundary(std::make_unique<particles::BoundaryParticles<dim>>(*m_grid)),
      m_step(make_step(setup)),
      m_courant(setup.courant),
      m_largest_courant(stable_courant({setup.basis, setup.ends, setup.scheme, setup.transfer})) {
  m_options.body_force.uniform = setup.gravity;
  m_options.transfer = setup.transfer;
  m_options.flip_time = setup.flip_time;
  m_options.averaged_volume_share = setup.averaged_volume_share;
  if (setup.regularisation.is_on())
    m_regularisation = std::make_unique<Regularisation<dim>>(setup.regularisation, setup.lines,
                                                             setup.walls, *m_particles);
  seed(setup);
  declare_causes();
  open_ledger();
}

template <int dim>
std::unique_ptr<Step<dim>> Simulation<dim>::make_step(const SimulationSetup<dim>& setup) {
  return basis::with_basis(setup.basis, [&]<class Basis>() {
    return solver::make_step<dim, Basis>(
        setup.scheme, {*m_grid, bases<dim, Basis>(setup), m_walls, *m_particles, *m_boundary,
                       m_constraints, m_ledger});
  });
}

template <int dim>
std::unique_ptr<grid::Grid<dim>> Simulation<dim>::make_grid(
    const SimulationSetup<dim>& setup) const {
  const partition::CellWork<dim> particles = seed_counts(setup);
  auto grid = std::make_unique<grid::Grid<dim>>(setup.communicator, node_lines(setup),
                                                m_balance.ranges(particles));
  if (setup.balance.method != LoadBalance::ranges && setup.communicator.size() > 1)
    grid->set_ownership(m_balance.ownership(particles, grid->ownership()));
  return grid;
}

template <int dim>
void Simulation<dim>::seed(const SimulationSetup<dim>& setup) {
  std::vector<particles::Seed<dim>> seeds;
  m_grid->owned_cells().for_each([&](const std::array<int, dim>& cell) {
    const auto more = particles::seeds_of_cell<dim>(setup.lines, cell, setup.filling);
    seeds.insert(seeds.end(), more.begin(), more.end());
  });
  m_particles->add(seeds);
  if (m_particles->global_count() == 0)
    throw BadInput("no cell of the grid holds a particle: refine the grid or enlarge the body");
}

template <int dim>
void Simulation<dim>::add_constraint(std::shared_ptr<grid::Constraint<dim>> constraint) {
  m_ledger.cause(constraint->label()).is_body = true;
  m_constraints.push_back(constraint.get());
  m_owned_constraints.push_back(std::move(constraint));
}

template <int dim>
void Simulation<dim>::start_from_rest() {
  {
    const particles::ParticleView<dim> view = m_particles->view();
    for (int p = 0; p < view.count; ++p) {
      for (int d = 0; d < dim; ++d) view.velocity[d][p] = view.displacement[d][p] = 0.0;
      if (m_options.transfer == Transfer::apic)
        for (const auto& row : view.velocity_gradient)
          for (double* component : row) component[p] = 0.0;
      view.deviatoric_strain[p] = 0.0;
    }
  }
  m_dt_old = 0.0;
  open_ledger();
}

template <int dim>
void Simulation<dim>::renew_time_step() {
  const petsc::Phase phase("mpm: time step");
  const Transit mine = m_step->transit();
  // A runaway makes the smallest negative, so that all learn of it in the same reduction.
  const double transit = communicator().minimum(mine.runaway >= 0 ? -1.0 : mine.smallest);
  if (transit < 0.0) stop_at(mine.runaway, Fault::runaway, {.dt = m_stable_dt});
  const double stable = m_courant * transit;
  const double previous = m_stable_dt;
  m_stable_dt = previous > 0.0 ? std::min(stable, largest_growth_of_dt * previous) : stable;
  m_steps_since_renewal = 0;
  if (m_first_dt == 0.0) m_first_dt = stable;
  if (!(stable >= smallest_share_of_dt * m_first_dt))
    stop_at(mine.smallest <= transit ? mine.of_particle : -1, Fault::collapsed_step,
            {.dt = m_stable_dt});
}

/// Before a step, when what the last one left on the nodes has been read.
template <int dim>
void Simulation<dim>::rebalance() {
  constexpr double worth_it = 0.98;  // of the present imbalance
  if (imbalance() <= m_balance.rebalance_above()) return;
  const int ranks = communicator().size();
  const partition::CellWork<dim> counts = m_particles->count_in_cells();
  partition::Ownership<dim> next = m_balance.ownership(counts, m_grid->ownership());
  if (partition::imbalance(counts, next, ranks) >
      worth_it * partition::imbalance(counts, m_grid->ownership(), ranks))
    return;
  m_grid->set_ownership(std::move(next));
  migrate();
  ++m_rebalancings;
}

template <int dim>
void Simulation<dim>::migrate() {
  m_particles->migrate();
  if (!m_boundary->is_empty()) m_boundary->migrate();
  m_steps_since_sort = 0;
}

template <int dim>
double Simulation<dim>::plan(double limit) {
  if (m_balance.is_due(m_steps)) rebalance();
  if (m_stable_dt == 0.0 || m_steps_since_renewal >= steps_between_renewals) renew_time_step();
  return std::min(m_stable_dt, limit);
}

template <int dim>
StepTimes Simulation<dim>::advance(double time, double dt) {
  const StepTimes times{.time = time, .dt = dt, .dt_old = m_dt_old};
  if (m_body_force)
    m_options.body_force.at_reference_position = [this, time](const Vector<dim>& X) {
      return m_body_force(X, time);
    };
  for (auto* constraint : m_constraints) constraint->look_at_particles(dt);
  if (m_regularisation) m_regularisation->begin_step();
  agree(m_step->advance(times, m_options), times);
  if (m_regularisation) m_regularisation->end_step();
  m_dt_old = dt;
  ++m_steps;
  ++m_steps_since_renewal;
  return times;
}

/// What any rank needs, one bit for each need. What ranks tell each other besides comes along.
/// Collective.
template <int dim>
int Simulation<dim>::agreed(int mine) {
  const petsc::Phase phase("mpm: agree");
  const int all = communicator().united_bits((mine << heard_bits) | m_told);
  m_heard = all & ((1 << heard_bits) - 1);
  return all >> heard_bits;
}

/// All ranks learn whether one of them has to stop or to hand particles over.
template <int dim>
void Simulation<dim>::agree(const StepReport& report, const StepTimes& times) {
  enum Need { nothing = 0, migration = 1, stop = 2 };
  const int mine = report.broken_particle >= 0 ? stop : report.must_migrate ? migration : nothing;
  const int all = agreed(mine);
  if ((all & stop) != 0) stop_at(report.broken_particle, Fault::broken, times);
  if ((all & migration) != 0) {
    migrate();
  } else if (++m_steps_since_sort >= steps_between_sorts) {
    m_particles->sort();
    m_steps_since_sort = 0;
  }
}

template <int dim>
double Simulation<dim>::unbalanced_force() const {
  return communicator().sum(m_step->unbalanced_force());
}

template <int dim>
double Simulation<dim>::out_of_balance() const {
  double g = 0.0;
  for (double component : m_options.body_force.uniform) g += component * component;
  return unbalanced_force() / (total_mass() * std::sqrt(g));
}

namespace {

template <int dim>
double kinetic_energy_of(const particles::ParticleView<dim>& view) {
  double energy = 0.0;
  for (int p = 0; p < view.count; ++p)
    for (int d = 0; d < dim; ++d)
      energy += 0.5 * view.mass[p] * view.velocity[d][p] * view.velocity[d][p];
  return energy;
}

template <int dim>
Vector<dim> momentum_of(const particles::ParticleView<dim>& view) {
  Vector<dim> sum{};
  for (int p = 0; p < view.count; ++p)
    for (int d = 0; d < dim; ++d) sum[d] += view.mass[p] * view.velocity[d][p];
  return sum;
}

/// Sum of m |v|.
template <int dim>
double motion_of(const particles::ParticleView<dim>& view) {
  double motion = 0.0;
  for (int p = 0; p < view.count; ++p) {
    double square = 0.0;
    for (int d = 0; d < dim; ++d) square += view.velocity[d][p] * view.velocity[d][p];
    motion += view.mass[p] * std::sqrt(square);
  }
  return motion;
}

}  // namespace

template <int dim>
double Simulation<dim>::kinetic_energy() const {
  return communicator().sum(kinetic_energy_of<dim>(m_particles->view()));
}

template <int dim>
Vector<dim> Simulation<dim>::momentum() const {
  Vector<dim> sum = momentum_of<dim>(m_particles->view());
  for (double& component : sum) component = communicator().sum(component);
  return sum;
}

/// All that there can be, in one order on all ranks.
template <int dim>
void Simulation<dim>::declare_causes() {
  for (const char* name : {"gravity", "loads", "damping"}) m_ledger.cause(name);
  for (int d = 0; d < dim; ++d)
    for (int side : {0, 1})
      if (m_walls.kind(d, side) != grid::Wall::free) m_ledger.cause(wall_cause(2 * d + side));
}

template <int dim>
void Simulation<dim>::open_ledger() {
  m_ledger.open(summed(particle_sums(), communicator()));
}

/// This rank's share.
template <int dim>
ParticleSums<dim> Simulation<dim>::particle_sums() const {
  const particles::ParticleView<dim> view = m_particles->view();
  return {momentum_of(view), kinetic_energy_of(view), motion_of(view), strain_energy(view)};
}

/// This rank's share; nothing where one of the laws has none.
template <int dim>
std::optional<double> Simulation<dim>::strain_energy(
    const particles::ParticleView<dim>& view) const {
  const particles::Materials& laws = m_particles->materials();
  if (!std::ranges::all_of(laws, [](const auto& law) { return law->has_strain_energy(); }))
    return {};
  double energy = 0.0;
  std::vector<double> density(static_cast<std::size_t>(view.count));
  for (std::size_t k = 0; k < laws.size(); ++k) {
    const auto material = static_cast<int>(k);
    const particles::Range range = m_particles->range_of(material);
    laws[k]->strain_energy_density(m_particles->batch_of(view, material), density);
    for (int i = 0; i < range.size(); ++i)
      energy += view.volume[range.first + i] * density[static_cast<std::size_t>(i)];
  }
  return energy;
}

template <int dim>
double Simulation<dim>::total_mass() const {
  const particles::ParticleView<dim> view = m_particles->view();
  double sum = 0.0;
  for (int p = 0; p < view.count; ++p) sum += view.mass[p];
  return communicator().sum(sum);
}

template <int dim>
double Simulation<dim>::imbalance() const {
  const auto largest = communicator().maximum(static_cast<double>(m_particles->local_count()));
  return largest * communicator().size() / static_cast<double>(m_particles->global_count());
}

template class Simulation<1>;
template class Simulation<2>;
template class Simulation<3>;

}  // namespace mpm::solver
