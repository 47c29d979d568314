#include <gtest/gtest.h>

#include <cmath>

#include "mpm/cases/Ground.hpp"
#include "mpm/contact/TableMotion.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/geometry/Box.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/particles/SurfacePieces.hpp"

namespace mpm::cases {
namespace {

/// Clay of 17 kN/m^3 below sand of 19 kN/m^3 from -1.3 m on, with a ball of 23 kN/m^3 in it.
Ground<2> layers(double pressure) {
  const auto box = [](double bottom, double top) {
    return std::make_shared<geometry::Box<2>>(Vector<2>{-4.0, bottom}, Vector<2>{4.0, top});
  };
  return Ground<2>({{.name = "clay", .shape = box(-5.0, 0.2), .unit_weight = 17e3, .K0 = 0.8},
                    {.name = "sand", .shape = box(-1.3, 0.2), .unit_weight = 19e3, .K0 = 0.4},
                    {.name = "stone",
                     .shape = std::make_shared<geometry::Ball<2>>(0.5, Vector<2>{1.0, -3.0}),
                     .unit_weight = 23e3,
                     .K0 = 1.1}},
                   [pressure](const Vector<2>& x) { return x[0] > 0.0 ? pressure : 0.0; });
}

TEST(Ground, stress_at_rest_is_the_weight_of_the_layers_above) {
  const SymmetricTensor in_sand = layers(0.0).stress_at({-2.0, -0.7});
  EXPECT_NEAR(in_sand[1], -19e3 * 0.9, 1e-9);
  EXPECT_NEAR(in_sand[0], -0.4 * 19e3 * 0.9, 1e-9);
  EXPECT_NEAR(in_sand[2], in_sand[0], 1e-12);
  const SymmetricTensor in_clay = layers(0.0).stress_at({-2.0, -3.3});
  EXPECT_NEAR(in_clay[1], -(19e3 * 1.5 + 17e3 * 2.0), 1e-9);
  EXPECT_NEAR(in_clay[0], 0.8 * in_clay[1], 1e-9);
}

TEST(Ground, an_inclusion_weighs_on_what_is_below_it) {
  const double above_stone = 19e3 * 1.5 + 17e3 * 1.2;
  EXPECT_NEAR(layers(0.0).stress_at({1.0, -2.5 - 0.1})[1], -(above_stone + 23e3 * 0.1), 1e-9);
  EXPECT_NEAR(layers(0.0).stress_at({1.0, -4.0})[1], -(above_stone + 23e3 + 17e3 * 0.5), 1e-9);
  EXPECT_EQ(layers(0.0).region_at({1.0, -3.0}), 2);
}

TEST(Ground, a_surcharge_acts_below_the_surface_that_it_presses_on) {
  EXPECT_NEAR(layers(6e3).stress_at({2.0, -0.7})[1], -(6e3 + 19e3 * 0.9), 1e-9);
  EXPECT_NEAR(layers(6e3).stress_at({-2.0, -0.7})[1], -19e3 * 0.9, 1e-9);
}

TEST(Ground, below_a_slope_the_column_ends_at_the_slope) {
  const Ground<2> slope(
      {{.name = "fill",
        .shape = std::make_shared<geometry::HalfSpace<2>>(Vector<2>{0.6, 0.8}, Vector<2>{1.0, 2.0}),
        .unit_weight = 18e3,
        .K0 = 0.5}},
      [](const auto&) { return 0.0; });
  // 0.6 (x - 1) + 0.8 (y - 2) = 0 at x = 3: y = 0.5.
  EXPECT_NEAR(slope.stress_at({3.0, -0.7})[1], -18e3 * 1.2, 1e-9);
  EXPECT_EQ(slope.region_at({3.0, 0.6}), std::nullopt);
}

TEST(Ground, under_turned_gravity_is_level_ground_turned) {
  const double angle = 0.35, c = std::cos(angle), s = std::sin(angle);
  const auto turned = [&](double x, double y) { return Vector<2>{c * x - s * y, s * x + c * y}; };
  const auto half_space = [&](double height) {
    return std::make_shared<geometry::HalfSpace<2>>(turned(0.0, 1.0), turned(0.0, height));
  };
  const Ground<2> ground(
      {{.name = "sand", .shape = half_space(0.2), .unit_weight = 19e3, .K0 = 0.4},
       {.name = "clay", .shape = half_space(-1.3), .unit_weight = 17e3, .K0 = 0.8}},
      [](const auto&) { return 0.0; }, turned(0.0, 1.0));
  const SymmetricTensor stress = ground.stress_at(turned(0.7, -3.3));
  const double vertical = -(19e3 * 1.5 + 17e3 * 2.0), horizontal = 0.8 * vertical;
  EXPECT_NEAR(stress[0], c * c * horizontal + s * s * vertical, 1e-9);
  EXPECT_NEAR(stress[1], s * s * horizontal + c * c * vertical, 1e-9);
  EXPECT_NEAR(stress[2], horizontal, 1e-9);
  EXPECT_NEAR(stress[3], c * s * (horizontal - vertical), 1e-9);
}

TEST(SurfacePieces, make_up_the_faces_of_a_block) {
  const auto line = basis::KnotLines::uniform(0.0, 2.0, 10);
  const particles::Filling<2> block{
      [](const Vector<2>& x) {
        return x[0] > 0.4 && x[0] < 1.6 && x[1] < 1.2 ? std::optional(0) : std::nullopt;
      },
      [](const auto&) { return 3; }};
  double area = 0.0, load = 0.0;
  for (const auto& piece : particles::surface_pieces<2>(
           {line, line}, block, 3, [](const auto& x) { return x[0] > 1.0 ? 700.0 : 0.0; })) {
    EXPECT_EQ(piece.area[0], 0.0);
    EXPECT_NEAR(piece.anchor[1] + piece.offset[1], 1.2, 1e-14);
    area += piece.area[1];
    load += piece.pressure * piece.area[1];
  }
  EXPECT_NEAR(area, 0.6, 1e-13);
  EXPECT_NEAR(load, 420.0, 1e-10);
  for (const auto& piece :
       particles::surface_pieces<2>({line, line}, block, 0, [](const auto&) { return 1.0; })) {
    EXPECT_NEAR(piece.anchor[0] + piece.offset[0], 0.4, 1e-14);
    EXPECT_LT(piece.area[0], 0.0);
  }
}

TEST(TableMotion, is_linear_between_rows_and_holds_beyond_them) {
  const contact::TableMotion<2> motion({{0.5, {{1.0, -2.0}, 0.4}}, {1.5, {{3.0, 0.0}, 0.0}}});
  EXPECT_EQ(motion.at(0.1).translation, (Vector<2>{1.0, -2.0}));
  EXPECT_NEAR(motion.at(0.75).translation[0], 1.5, 1e-15);
  EXPECT_NEAR(motion.at(0.75).translation[1], -1.5, 1e-15);
  EXPECT_NEAR(motion.at(0.75).spin, 0.3, 1e-15);
  EXPECT_EQ(motion.at(7.0).translation, (Vector<2>{3.0, 0.0}));
  EXPECT_THROW(contact::TableMotion<2>({{1.0, {}}, {1.0, {}}}), BadInput);
  EXPECT_THROW(contact::TableMotion<2>({}), BadInput);
}

}  // namespace
}  // namespace mpm::cases
