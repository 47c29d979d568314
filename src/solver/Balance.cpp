#include "mpm/solver/Balance.hpp"

#include "mpm/grid/Grid.hpp"
#include "mpm/partition/MetisBlocks.hpp"

namespace mpm::solver {
namespace {

/// Work of a cell without particles, of a particle's. Its node may be updated, and ranges are to be
/// of some length where nothing is; METIS only needs to know that no block is free.
constexpr double empty_cell_of_ranges = 0.1, empty_cell_of_metis = 0.01;

template <int dim>
partition::CellWork<dim> work_of(partition::CellWork<dim> particles, double empty_cell) {
  for (double& work : particles.work) work += empty_cell;
  return particles;
}

/// What METIS says on the first rank holds on all.
template <int dim>
partition::Ownership<dim> common_blocks(const petsc::Communicator& communicator,
                                        const partition::CellWork<dim>& work,
                                        const partition::Ownership<dim>& previous) {
  std::array<std::vector<int>, dim> starts;
  std::vector<int> ranks;
  if (communicator.is_root()) {
    const auto blocks = partition::metis_blocks(work, communicator.size(), previous);
    for (int d = 0; d < dim; ++d) starts[d] = blocks.starts(d);
    ranks = blocks.ranks();
  }
  for (auto& line : starts) communicator.broadcast(line);
  communicator.broadcast(ranks);
  return {std::move(starts), std::move(ranks)};
}

}  // namespace

template <int dim>
Balance<dim>::Balance(const petsc::Communicator& communicator,
                      const std::array<basis::NodeLine, dim>& nodes, const BalanceOptions& options)
    : m_communicator(communicator), m_options(options) {
  for (int d = 0; d < dim; ++d) m_request.nodes[d] = nodes[d].count();
  m_request.owner_offset = nodes[0].owner_offset;
  m_request.smallest_range = grid::Grid<dim>::stencil_width(nodes[0]);
  m_request.ranks = communicator.size();
}

template <int dim>
partition::Layout<dim> Balance<dim>::ranges(const partition::CellWork<dim>& particles) const {
  partition::LayoutRequest<dim> request = m_request;
  request.work = work_of(particles, empty_cell_of_ranges);
  return partition::balanced_layout(request);
}

template <int dim>
partition::Ownership<dim> Balance<dim>::ownership(const partition::CellWork<dim>& particles,
                                                  const partition::Ownership<dim>& previous) const {
  if (m_options.method == LoadBalance::metis)
    return common_blocks(m_communicator, work_of(particles, empty_cell_of_metis), previous);
  return partition::ownership_of<dim>(ranges(particles), particles.cells, m_request.owner_offset);
}

template <int dim>
bool Balance<dim>::is_due(long long step) const {
  return m_request.ranks > 1 && m_options.rebalance_above > 0.0 && step > 0 &&
         step % m_options.steps_between_checks == 0;
}

template class Balance<1>;
template class Balance<2>;
template class Balance<3>;

}  // namespace mpm::solver
