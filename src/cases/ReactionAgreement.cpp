#include "mpm/cases/ReactionAgreement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mpm::cases {
namespace {

constexpr double first_place = 0.05;  // u/D
constexpr int rows_of_a_mean = 4;

}  // namespace

ReactionAgreement compare_reactions(const run::History<2>& history, const ReactionColumns& columns,
                                    double last_place) {
  double largest = 0.0, squares = 0.0, compared = 0.0, contact = 0.0, contour = 0.0;
  int rows = 0;
  for (const auto& row : history.rows()) {
    if (row[columns.place] < first_place || row[columns.place] > last_place) continue;
    contact += row[columns.by_impulse];
    contour += row[columns.by_contour];
    if (++rows % rows_of_a_mean != 0) continue;
    const double difference = contour / contact - 1.0;
    largest = std::max(largest, std::abs(difference));
    squares += difference * difference;
    compared += 1.0;
    contact = contour = 0.0;
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (compared == 0.0) return {none, none};
  return {std::sqrt(squares / compared), largest};
}

}  // namespace mpm::cases
