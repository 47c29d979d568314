#include "mpm/cases/ReactionAgreement.hpp"

#include <algorithm>
#include <cmath>

namespace mpm::cases {
namespace {

constexpr double first_place = 0.05, last_place = 0.9;  // u/D
constexpr int rows_of_a_mean = 4;

}  // namespace

void report_agreement(const run::History<2>& history, const ReactionColumns& columns,
                      io::Summary& summary) {
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
  if (compared == 0.0) return;
  summary.set("reaction_difference_rms", std::sqrt(squares / compared));
  summary.set("reaction_difference_max", largest);
}

}  // namespace mpm::cases
