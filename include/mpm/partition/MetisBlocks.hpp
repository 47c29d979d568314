#pragma once

#include "mpm/partition/Ownership.hpp"

namespace mpm::partition {

/// Parts by METIS of blocks of cells, four per direction or, where single blocks are too heavy to
/// be shared out evenly, less. Blocks at the end take the cells that are left, so that a wall and
/// what is mirrored at it have one owner. Parts get the ranks that had most of their work before.
/// Local; the same wherever METIS is the same.
template <int dim>
Ownership<dim> metis_blocks(const CellWork<dim>& work, int ranks, const Ownership<dim>& previous);

}  // namespace mpm::partition
