#pragma once

#include <cstddef>

#include "mpm/io/Summary.hpp"
#include "mpm/run/History.hpp"

namespace mpm::cases {

/// Columns of a history that has both reactions.
struct ReactionColumns {
  std::size_t place;  ///< u/D
  std::size_t by_impulse, by_contour;
};

/// Compares the two reactions over 0.05 <= u/D <= 0.9, on means of four rows: sets
/// reaction_difference_rms and _max, or nothing where there are no four rows.
void report_agreement(const run::History<2>& history, const ReactionColumns& columns,
                      io::Summary& summary);

}  // namespace mpm::cases
