#pragma once

#include "mpm/basis/Bases.hpp"
#include "mpm/solver/Step.hpp"

namespace mpm::solver {

/// What the largest stable step depends on besides cells and wave speed.
struct Method {
  basis::Kind basis;
  basis::EndTreatment ends;
  Scheme scheme;
  Transfer transfer;
};

/// The largest Courant number at which one step lets nothing grow in an elastic body: the lowest
/// limit in docs/data/stability.csv, over one and two dimensions, 1 to 4 particles per direction,
/// inside, at walls and at a free surface anywhere in its cell. `-scene stability` finds it.
double stable_courant(const Method& method);

}  // namespace mpm::solver
