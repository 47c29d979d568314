#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "mpm/core/Principal.hpp"

namespace mpm {
namespace {

double dot(const Vector<3>& a, const Vector<3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector<3> product(const SymmetricTensor& a, const Vector<3>& v) {
  return {a[0] * v[0] + a[3] * v[1] + a[5] * v[2], a[3] * v[0] + a[1] * v[1] + a[4] * v[2],
          a[5] * v[0] + a[4] * v[1] + a[2] * v[2]};
}

std::vector<SymmetricTensor> awkward_tensors() {
  std::vector<SymmetricTensor> tensors{{{0, 0, 0, 0, 0, 0}},
                                       {{-3, -3, -3, 0, 0, 0}},
                                       {{2, -5, 2, 0, 0, 0}},
                                       {{1, 1, 1, 1, 1, 1}},
                                       {{4, 4, -7, 1e-13, 0, 0}},
                                       {{1e9, 1, -1e-6, 2e-3, -0.4, 30}},
                                       {{-8, -8, -8, 1e-9, -1e-9, 1e-9}},
                                       {{3, -2, 5, 4, 0, 0}},
                                       {{0, 0, 0, 0, 0, 2}}};
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 500; ++k) {
    SymmetricTensor a;
    for (double& component : a.components) component = 3e4 * normal(random);
    tensors.push_back(a);
  }
  return tensors;
}

TEST(Principal, axes_are_orthonormal_and_values_belong_to_them) {
  for (const SymmetricTensor& a : awkward_tensors()) {
    const Principal p = principal(a);
    EXPECT_GE(p.value[0], p.value[1]);
    EXPECT_GE(p.value[1], p.value[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(dot(p.axis[i], p.axis[j]), i == j ? 1.0 : 0.0, 1e-14);
      const Vector<3> image = product(a, p.axis[i]);
      for (std::size_t d = 0; d < 3; ++d)
        EXPECT_NEAR(image[d], p.value[i] * p.axis[i][d], 4e-15 * norm(a));
    }
  }
}

TEST(Principal, compose_gives_the_tensor_back) {
  for (const SymmetricTensor& a : awkward_tensors())
    EXPECT_LE(norm(compose(principal(a)) + (-1.0) * a), 4e-15 * norm(a));
}

TEST(Principal, values_of_a_known_tensor) {
  const auto value = principal({{-60.0, 20.0, -7.0, 30.0, 0.0, 0.0}}).value;
  EXPECT_NEAR(value[0], 30.0, 1e-13);
  EXPECT_NEAR(value[1], -7.0, 1e-13);
  EXPECT_NEAR(value[2], -70.0, 1e-13);
}

TEST(Principal, plane_strain_stays_in_its_plane) {
  const SymmetricTensor a = compose(principal({{-3e4, -1e4, -2.2e4, 0.7e4, 0.0, 0.0}}));
  EXPECT_EQ(a[4], 0.0);
  EXPECT_EQ(a[5], 0.0);
}

TEST(Principal, hands_on_what_is_not_a_number) {
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(trace(compose(principal({{nan, nan, nan, nan, nan, nan}})))));
}

}  // namespace
}  // namespace mpm
