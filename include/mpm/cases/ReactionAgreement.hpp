#pragma once

#include <cstddef>

#include "mpm/run/History.hpp"

namespace mpm::cases {

/// Columns of a history that has both reactions.
struct ReactionColumns {
  std::size_t place;  ///< u/D
  std::size_t by_impulse, by_contour;
};

/// Relative difference of the two reactions, on means of four rows; not a number where there are
/// none.
struct ReactionAgreement {
  double rms;
  double largest;
};

/// Over 0.05 <= u/D <= last_place.
ReactionAgreement compare_reactions(const run::History<2>& history, const ReactionColumns& columns,
                                    double last_place);

}  // namespace mpm::cases
