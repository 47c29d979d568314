#include "mpm/partition/Comparison.hpp"

#include "mpm/partition/MetisBlocks.hpp"

namespace mpm::partition {

template <int dim>
Imbalances compare(const LayoutRequest<dim>& request) {
  const auto owners = [&](const Layout<dim>& layout) {
    return ownership_of<dim>(layout, request.work.cells, request.owner_offset);
  };
  const auto measure = [&](const Ownership<dim>& ownership) {
    return imbalance(request.work, ownership, request.ranks);
  };
  const Ownership<dim> uniform = owners(uniform_layout(request));
  return {measure(uniform), measure(owners(balanced_layout(request))),
          measure(metis_blocks(request.work, request.ranks, uniform))};
}

template Imbalances compare(const LayoutRequest<1>&);
template Imbalances compare(const LayoutRequest<2>&);
template Imbalances compare(const LayoutRequest<3>&);

}  // namespace mpm::partition
