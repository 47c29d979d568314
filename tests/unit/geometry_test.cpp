#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/core/Errors.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/geometry/Box.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/geometry/Polygon.hpp"
#include "mpm/geometry/ShapeKinds.hpp"

namespace mpm::geometry {
namespace {

const std::vector<double> arrow{-0.7, -0.4, 0.9, -0.4, 0.9, 0.8, 0.2, 0.1, -0.7, 0.8};

/// One shape of every kind of the plane, none in a special place.
std::vector<std::unique_ptr<Shape<2>>> shapes() {
  std::vector<std::unique_ptr<Shape<2>>> all;
  all.push_back(std::make_unique<Box<2>>(Vector<2>{-0.4, 0.1}, Vector<2>{0.7, 0.6}));
  all.push_back(std::make_unique<Ball<2>>(0.45, Vector<2>{0.13, -0.21}));
  all.push_back(make_shape<2>(2, arrow));
  all.push_back(std::make_unique<HalfSpace<2>>(Vector<2>{0.6, 0.8}, Vector<2>{0.1, 0.3}));
  return all;
}

template <class Check>
void for_every_shape_and_point(const Check& check) {
  for (const auto& shape : shapes())
    for (double x = -1.47; x < 1.5; x += 0.13)
      for (double y = -1.43; y < 1.5; y += 0.17) check(*shape, Vector<2>{x, y});
}

TEST(Shape, following_the_normal_for_the_distance_leads_to_the_surface) {
  for_every_shape_and_point([](const Shape<2>& shape, const Vector<2>& x) {
    const Proximity<2> place = shape.locate(x);
    EXPECT_NEAR(std::hypot(place.normal[0], place.normal[1]), 1.0, 1e-14);
    const Vector<2> foot{x[0] - place.distance * place.normal[0],
                         x[1] - place.distance * place.normal[1]};
    EXPECT_NEAR(shape.locate(foot).distance, 0.0, 1e-14);
  });
}

TEST(Shape, no_point_of_the_surface_is_nearer_than_the_distance) {
  for_every_shape_and_point([](const Shape<2>& shape, const Vector<2>& x) {
    const double distance = std::abs(shape.locate(x).distance);
    if (distance < 1e-12) return;
    for (int k = 0; k < 24; ++k) {
      const double angle = k * std::numbers::pi / 12.0, reach = 0.99 * distance;
      const Vector<2> other{x[0] + reach * std::cos(angle), x[1] + reach * std::sin(angle)};
      EXPECT_GT(shape.locate(x).distance * shape.locate(other).distance, 0.0);
    }
  });
}

TEST(Shape, lines_cross_the_surface_where_inside_and_outside_meet) {
  for (const double angle : {0.0, 0.3, 1.9, -2.8})
    for_every_shape_and_point([angle](const Shape<2>& shape, const Vector<2>& x) {
      const Vector<2> along{-std::sin(angle), std::cos(angle)};
      const auto ahead = [&](double way) {
        return Vector<2>{x[0] + way * along[0], x[1] + way * along[1]};
      };
      const std::vector<double> ways = shape.crossings(x, along);
      for (const double way : ways) EXPECT_NEAR(shape.locate(ahead(way)).distance, 0.0, 1e-13);
      const auto count = std::ranges::count_if(ways, [](double way) { return way > 0.0; });
      const bool end_is_inside = shape.locate(ahead(1e3)).distance < 0.0;
      EXPECT_EQ(shape.locate(x).distance < 0.0, (count % 2 == 1) != end_is_inside);
    });
}

TEST(Shape, moves_with_its_reference) {
  const Vector<2> by{0.31, -1.7};
  for_every_shape_and_point([&](const Shape<2>& shape, const Vector<2>& x) {
    const auto moved = shape.moved(by);
    EXPECT_NEAR(moved->locate({x[0] + by[0], x[1] + by[1]}).distance, shape.locate(x).distance,
                1e-14);
    for (int d = 0; d < 2; ++d)
      EXPECT_NEAR(moved->reference()[d], shape.reference()[d] + by[d], 1e-14);
  });
}

TEST(Shape, a_cuboid_is_nearest_at_face_edge_or_corner) {
  const Box<3> box({-1.0, -2.0, -3.0}, {1.5, 2.5, 3.5});
  EXPECT_NEAR(box.locate({1.0, 0.0, 0.0}).distance, -0.5, 1e-15);
  EXPECT_EQ(box.locate({1.0, 0.0, 0.0}).normal, (Vector<3>{1.0, 0.0, 0.0}));
  EXPECT_NEAR(box.locate({1.8, 2.9, 0.0}).distance, 0.5, 1e-15);
  EXPECT_NEAR(box.locate({1.7, 2.8, 4.1}).distance, 0.7, 1e-15);
  EXPECT_NEAR(box.locate({1.7, 2.8, 4.1}).normal[2], 0.6 / 0.7, 1e-15);
}

TEST(Polygon, has_the_centroid_of_its_area_whatever_the_sense_of_its_corners) {
  const std::vector<Vector<2>> corners{{1.0, 2.0}, {4.0, 2.0}, {1.0, 8.0}};
  const Polygon triangle(corners), other({corners.rbegin(), corners.rend()});
  EXPECT_NEAR(triangle.reference()[0], 2.0, 1e-14);
  EXPECT_NEAR(triangle.reference()[1], 4.0, 1e-14);
  EXPECT_NEAR(other.reference()[1], 4.0, 1e-14);
  EXPECT_EQ(other.locate({1.5, 3.0}).distance, triangle.locate({1.5, 3.0}).distance);
  EXPECT_NEAR(triangle.locate({1.5, 3.0}).distance, -0.5, 1e-14);
}

TEST(Polygon, is_refused_where_it_encloses_nothing_or_its_sides_cross) {
  EXPECT_THROW(Polygon({{0.0, 0.0}, {1.0, 2.0}}), BadInput);
  EXPECT_THROW(Polygon({{0.0, 0.0}, {1.0, 1.0}, {3.0, 3.0}}), BadInput);
  EXPECT_THROW(Polygon({{0.0, 0.0}, {2.0, 1.0}, {2.0, 0.0}, {0.0, 1.5}}), BadInput);
}

TEST(ShapeKinds, make_what_the_numbers_say_and_refuse_others) {
  const std::vector<double> layer{-1.5, -0.5};
  EXPECT_NEAR(make_shape<2>(3, layer)->locate({7.0, -0.8}).distance, -0.3, 1e-15);
  EXPECT_NEAR(make_shape<3>(3, layer)->locate({7.0, 0.1, -3.0}).distance, 0.6, 1e-15);
  EXPECT_NEAR(make_shape<1>(3, layer)->locate({-2.0}).distance, 0.5, 1e-15);
  const std::vector<double> plane{1.0, 2.0, 0.0, -3.0};
  EXPECT_NEAR(make_shape<2>(4, plane)->locate({5.0, 1.5}).distance, 0.5, 1e-15);
  const std::vector<double> upside_down{0.0, 1.0, 1.0, 0.5}, three{1.0, 2.0, 3.0};
  EXPECT_THROW(make_shape<2>(0, upside_down), BadInput);
  EXPECT_THROW(make_shape<2>(0, three), BadInput);
  EXPECT_THROW(make_shape<3>(2, arrow), BadInput);
  const std::vector<double> negative{0.0, 0.0, -1.0}, no_normal{0.0, 0.0, 0.0, 0.0};
  EXPECT_THROW(make_shape<2>(1, negative), BadInput);
  EXPECT_THROW(make_shape<2>(4, no_normal), BadInput);
}

}  // namespace
}  // namespace mpm::geometry
