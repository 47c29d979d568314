#include <gtest/gtest.h>

#include <algorithm>

#include <cmath>
#include <functional>
#include <numeric>

#include "mpm/basis/BSpline.hpp"
#include "mpm/basis/Ddmp.hpp"
#include "mpm/basis/Gimp.hpp"
#include "mpm/core/Errors.hpp"

namespace mpm::basis {
namespace {

KnotLines graded() {
  return KnotLines({-0.3, 0.1, 0.55, 1.2, 2.3, 2.9, 3.1, 4.0});
}

std::vector<double> probes(const KnotLines& lines) {
  std::vector<double> x;
  for (int cell = 0; cell < lines.cells(); ++cell)
    for (double xi : {0.0, 0.13, 0.5, 0.97}) x.push_back(lines.line(cell) + xi * lines.width(cell));
  x.push_back(lines.end());
  return x;
}

template <class Check>
void for_every_basis(const Check& check) {
  for (const KnotLines& lines : {KnotLines::uniform(-1.3, 2.4, 7), graded()}) {
    for (int particles_per_cell : {1, 2, 3}) check(Gimp(lines, particles_per_cell));
    check(Ddmp(lines));
    for (EndTreatment ends : {EndTreatment::mirror, EndTreatment::open_knot}) {
      check(BSpline<1>(lines, ends));
      check(BSpline<2>(lines, ends));
      check(BSpline<3>(lines, ends));
    }
  }
}

TEST(Basis, weights_sum_to_one_and_gradients_to_zero_up_to_every_wall) {
  for_every_basis([](const auto& basis) {
    for (double x : probes(basis.lines())) {
      typename std::decay_t<decltype(basis)>::Values N, dN;
      basis.evaluate(basis.lines().cell_of(x), x, N, dN);
      EXPECT_NEAR(std::accumulate(N.begin(), N.end(), 0.0), 1.0, 1e-14);
      EXPECT_NEAR(std::accumulate(dN.begin(), dN.end(), 0.0), 0.0, 1e-12);
    }
  });
}

TEST(Basis, linear_fields_at_greville_abscissae_are_reproduced_up_to_every_wall) {
  for_every_basis([](const auto& basis) {
    const NodeLine nodes = basis.nodes();
    for (double x : probes(basis.lines())) {
      typename std::decay_t<decltype(basis)>::Values N, dN;
      const int cell = basis.lines().cell_of(x);
      basis.evaluate(cell, x, N, dN);
      double position = 0.0, slope = 0.0;
      for (int a = 0; a < basis.support; ++a) {
        const auto I = static_cast<std::size_t>(basis.first_node(cell) + a);
        position += N[a] * nodes.positions[I];
        slope += dN[a] * nodes.positions[I];
      }
      EXPECT_NEAR(position, x, 1e-14 * 4.0);
      EXPECT_NEAR(slope, 1.0, 1e-12);
    }
  });
}

TEST(Basis, gradients_are_the_derivatives_of_the_weights) {
  for_every_basis([](const auto& basis) {
    const KnotLines& lines = basis.lines();
    for (int cell = 0; cell < lines.cells(); ++cell) {
      const double x = lines.line(cell) + 0.41 * lines.width(cell), step = 1e-6;
      typename std::decay_t<decltype(basis)>::Values N, dN, below, above, unused;
      basis.evaluate(cell, x, N, dN);
      basis.evaluate(cell, x - step, below, unused);
      basis.evaluate(cell, x + step, above, unused);
      for (int a = 0; a < basis.support; ++a)
        EXPECT_NEAR(dN[a], (above[a] - below[a]) / (2 * step), 1e-8);
    }
  });
}

TEST(Basis, cubic_splines_on_equal_cells_are_the_cardinal_ones) {
  const BSpline<3> basis(KnotLines::uniform(0.0, 3.0, 6), EndTreatment::mirror);
  BSpline<3>::Values N, dN;
  basis.evaluate(2, 1.0, N, dN);
  EXPECT_NEAR(N[0], 1.0 / 6, 1e-15);
  EXPECT_NEAR(N[1], 4.0 / 6, 1e-15);
  EXPECT_NEAR(N[2], 1.0 / 6, 1e-15);
  EXPECT_NEAR(N[3], 0.0, 1e-15);
  EXPECT_NEAR(dN[0], -0.5 / 0.5, 1e-14);
}

TEST(Basis, mirrored_splines_fold_onto_their_reflection_at_both_walls) {
  const BSpline<3> basis(graded(), EndTreatment::mirror);
  const KnotLines& lines = basis.lines();
  const NodeLine nodes = basis.nodes();
  EXPECT_EQ(nodes.reflected(0), 2);
  EXPECT_NEAR(nodes.positions[0] - lines.begin(), lines.begin() - nodes.positions[2], 1e-14);
  const auto last = static_cast<std::size_t>(nodes.count() - 1);
  EXPECT_NEAR(nodes.positions[last] - lines.end(), lines.end() - nodes.positions[last - 2], 1e-14);
}

TEST(Basis, an_open_end_interpolates_at_the_wall) {
  const BSpline<3> basis(graded(), EndTreatment::open_knot);
  BSpline<3>::Values N, dN;
  basis.evaluate(0, basis.lines().begin(), N, dN);
  EXPECT_NEAR(N[0], 1.0, 1e-15);
  EXPECT_NEAR(basis.nodes().positions[0], basis.lines().begin(), 1e-15);
}

/// Calls check(value, slope, x) with all nodes' smoothed functions at many places.
void for_smoothed_functions(const KnotLines& lines,
                            const std::function<void(const std::vector<double>&,
                                                     const std::vector<double>&, double)>& check) {
  const Ddmp basis(lines);
  for (double x : probes(lines)) {
    const int cell = lines.cell_of(x);
    Ddmp::Values value, slope;
    basis.evaluate_smoothed(cell, x, value, slope);
    std::vector<double> values(static_cast<std::size_t>(basis.count()), 0.0), slopes = values;
    for (std::size_t a = 0; a < Ddmp::support; ++a) {
      values[static_cast<std::size_t>(Ddmp::first_node(cell)) + a] = value[a];
      slopes[static_cast<std::size_t>(Ddmp::first_node(cell)) + a] = slope[a];
    }
    check(values, slopes, x);
  }
}

TEST(Ddmp, smoothed_slopes_reproduce_linear_fields_up_to_every_wall) {
  for (const KnotLines& lines : {KnotLines::uniform(-1.3, 2.4, 7), graded()}) {
    const NodeLine nodes = Ddmp(lines).nodes();
    for_smoothed_functions(lines, [&](const auto& values, const auto& slopes, double) {
      EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0), 1.0, 1e-14);
      EXPECT_NEAR(std::accumulate(slopes.begin(), slopes.end(), 0.0), 0.0, 1e-12);
      EXPECT_NEAR(std::inner_product(slopes.begin(), slopes.end(), nodes.positions.begin(), 0.0),
                  1.0, 1e-12);
    });
  }
}

TEST(Ddmp, smoothed_functions_are_the_projections_of_the_linear_ones_on_the_lines) {
  const KnotLines lines = graded();
  const BSpline<1> hats(lines, EndTreatment::mirror);
  // On line 3: int N_3 N_a dx / int N_3 dx and int N_3 N_a' dx / int N_3 dx by the midpoint rule.
  const int line = 3, pieces = 4000;
  std::vector<double> value(9, 0.0), slope(9, 0.0);
  double volume = 0.0;
  for (int cell = line - 1; cell <= line; ++cell)
    for (int k = 0; k < pieces; ++k) {
      const double dx = lines.width(cell) / pieces, x = lines.line(cell) + (k + 0.5) * dx;
      BSpline<1>::Values N, dN;
      hats.evaluate(cell, x, N, dN);
      const double weight = N[static_cast<std::size_t>(line - cell)] * dx;
      volume += weight;
      for (std::size_t a = 0; a < 2; ++a) {
        value[static_cast<std::size_t>(cell) + a] += weight * N[a];
        slope[static_cast<std::size_t>(cell) + a] += weight * dN[a];
      }
    }
  for_smoothed_functions(lines, [&](const auto& values, const auto& slopes, double x) {
    if (x != lines.line(line)) return;
    for (std::size_t node = 2; node < 5; ++node) {
      EXPECT_NEAR(values[node + 1], value[node] / volume, 1e-6);
      EXPECT_NEAR(slopes[node + 1], slope[node] / volume, 1e-6);
    }
  });
}

TEST(Ddmp, the_plain_gradient_rules_in_the_middle_of_a_cell_and_the_smoothed_one_at_its_ends) {
  const KnotLines lines = graded();
  const Ddmp basis(lines);
  for (int cell = 0; cell < lines.cells(); ++cell) {
    EXPECT_NEAR(basis.bubble(cell, lines.line(cell) + 0.5 * lines.width(cell)), 1.0, 1e-14);
    EXPECT_NEAR(basis.bubble(cell, lines.line(cell)), 0.0, 1e-14);
    EXPECT_NEAR(basis.bubble(cell, lines.line(cell + 1)), 0.0, 1e-14);
  }
}

/// Bardenhagen & Kober (2004): the function of a node at distance r, cells of width h, particles of
/// extent 2 l.
double closed_form_of_gimp(double r, double h, double l) {
  r = std::abs(r);
  if (r < l) return 1.0 - (r * r + l * l) / (2 * h * l);
  if (r < h - l) return 1.0 - r / h;
  if (r < h + l) return (h + l - r) * (h + l - r) / (4 * h * l);
  return 0.0;
}

TEST(Gimp, weights_on_equal_cells_are_the_closed_form) {
  const double h = 0.35;
  const KnotLines lines = KnotLines::uniform(-1.3, -1.3 + 7 * h, 7);
  for (int particles_per_cell : {1, 2, 3, 5}) {
    const Gimp basis(lines, particles_per_cell);
    const NodeLine nodes = basis.nodes();
    for (int k = 0; k < 7 * 40; ++k) {
      const double x = lines.begin() + (k + 0.37) * h / 40;
      const int cell = lines.cell_of(x);
      Gimp::Values S, dS;
      basis.evaluate(cell, x, S, dS);
      std::vector<double> all(nodes.positions.size(), 0.0);
      for (std::size_t a = 0; a < Gimp::support; ++a)
        all[static_cast<std::size_t>(Gimp::first_node(cell)) + a] = S[a];
      for (std::size_t I = 0; I < all.size(); ++I)
        EXPECT_NEAR(all[I],
                    closed_form_of_gimp(x - nodes.positions[I], h, 0.5 * h / particles_per_cell),
                    1e-13);
    }
  }
}

TEST(Gimp, weights_and_slopes_are_continuous_across_equal_cells) {
  const KnotLines lines = KnotLines::uniform(-1.3, 2.4, 7);
  for (int particles_per_cell : {1, 2, 3}) {
    const Gimp basis(lines, particles_per_cell);
    for (int cell = 1; cell < lines.cells(); ++cell) {
      Gimp::Values S, dS, next_S, next_dS;
      basis.evaluate(cell - 1, lines.line(cell), S, dS);
      basis.evaluate(cell, lines.line(cell), next_S, next_dS);
      EXPECT_NEAR(S[0], 0.0, 1e-13);
      EXPECT_NEAR(dS[0], 0.0, 1e-12);
      for (std::size_t a = 1; a < Gimp::support; ++a) {
        EXPECT_NEAR(S[a], next_S[a - 1], 1e-13);
        EXPECT_NEAR(dS[a], next_dS[a - 1], 1e-12);
      }
    }
  }
}

TEST(Gimp, a_single_cell_is_refused) {
  EXPECT_THROW(Gimp(KnotLines::uniform(-0.4, 0.9, 1), 2), BadInput);
  EXPECT_NO_THROW(Gimp(KnotLines::uniform(-0.4, 0.9, 2), 2));
}

TEST(KnotLines, the_cell_of_a_point_lies_around_it_and_outside_is_told) {
  const KnotLines lines = graded();
  for (double x : probes(lines)) {
    const int cell = lines.cell_of(x);
    ASSERT_GE(cell, 0);
    ASSERT_LT(cell, lines.cells());
    EXPECT_GE(x, lines.line(cell));
    EXPECT_LE(x, lines.line(cell + 1));
  }
  EXPECT_EQ(lines.cell_of(-0.31), -1);
  EXPECT_EQ(lines.cell_of(4.01), lines.cells());
  EXPECT_EQ(lines.cell_of(std::nan("")), -1);
}

TEST(KnotLines, lines_that_do_not_increase_are_refused) {
  EXPECT_THROW(KnotLines({0.0, 1.0, 1.0}), BadInput);
  EXPECT_THROW(KnotLines({0.0}), BadInput);
  EXPECT_THROW(BSpline<3>(KnotLines::uniform(0, 1, 2), EndTreatment::mirror), BadInput);
}

TEST(KnotLines, graded_ones_are_fine_where_wanted_and_grow_beyond) {
  const KnotLines lines = KnotLines::graded({.begin = -2.3,
                                             .end = 1.7,
                                             .fine_begin = -0.4,
                                             .fine_end = 0.3,
                                             .origin = 0.0,
                                             .cell = 0.1,
                                             .ratio = 2.5});
  EXPECT_LE(lines.begin(), -2.3);
  EXPECT_GE(lines.end(), 1.7);
  EXPECT_NE(std::ranges::find(lines.positions(), 0.0), lines.positions().end());
  for (int k = 0; k + 1 < lines.cells(); ++k) {
    const double ratio = lines.width(k + 1) / lines.width(k);
    EXPECT_LE(std::max(ratio, 1.0 / ratio), 1.05 + 1e-12);
    EXPECT_LE(lines.width(k), 0.25 + 1e-12);
    const double middle = 0.5 * (lines.line(k) + lines.line(k + 1));
    const bool is_fine = middle > -0.4 && middle < 0.3;
    EXPECT_NEAR(lines.width(k), is_fine ? 0.1 : lines.width(k), 1e-12);
  }
  EXPECT_GT(lines.width(0), 0.18);
}

}  // namespace
}  // namespace mpm::basis
