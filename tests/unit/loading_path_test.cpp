#include "mpm/material/LoadingPath.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/material/SandLaw.hpp"

namespace mpm::material {
namespace {

constexpr double E = 4.1e6, nu = 0.27;

LinearElastic elastic() {
  return LinearElastic({.youngs_modulus = E, .poisson_ratio = nu, .density = 1700.0});
}

std::vector<ElementTestRow> follow(const Material& material, double pressure,
                                   const std::string& text) {
  return run_element_test(material, {.kind = ElementTestKind::path,
                                     .confining_pressure = pressure,
                                     .path = read_path(text, "path.csv")});
}

// What a file says -------------------------------------------------------------------------------

TEST(LoadingPath, columns_in_any_order_become_legs_under_mixed_control) {
  const auto legs = read_path(
      "\xEF\xBB\xBF# comment\r\n"
      "stress_xx_Pa, increments, strain_yy, gamma_xy, strain_zz, stress_yz_Pa\r\n"
      "\r\n"
      " 25e3 ,7, -0.03, 0.004, hold, +300  # a leg\r\n"
      "hold,3,0.01,,0,\r\n",
      "path.csv");
  ASSERT_EQ(legs.size(), 2U);
  EXPECT_EQ(legs[0].increments, 7U);
  EXPECT_EQ(legs[0].control, (std::array{Control::stress, Control::strain, Control::strain,
                                         Control::strain, Control::stress, Control::strain}));
  EXPECT_EQ(legs[0].target[0], -25e3);
  EXPECT_EQ(legs[0].target[1], 0.03);
  EXPECT_EQ(legs[0].target[2], std::nullopt);
  EXPECT_EQ(legs[0].target[3], 0.002);
  EXPECT_EQ(legs[0].target[4], 300.0);
  EXPECT_EQ(legs[0].target[5], std::nullopt);
  EXPECT_EQ(legs[0].origin, "path.csv:4");
  EXPECT_EQ(legs[1].origin, "path.csv:5");
  EXPECT_EQ(legs[1].control[0], Control::stress);
  EXPECT_EQ(legs[1].target[0], std::nullopt);
  EXPECT_EQ(legs[1].control[4], Control::strain);
}

struct Mistake {
  const char* name;
  const char* text;
  std::vector<std::string> words;
};

class BadPath : public ::testing::TestWithParam<Mistake> {};

TEST_P(BadPath, is_refused_with_its_place_and_what_is_allowed) {
  try {
    read_path(GetParam().text, "path.csv");
    FAIL() << "accepted";
  } catch (const BadInput& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("-path_file path.csv"), std::string::npos) << message;
    for (const std::string& word : GetParam().words)
      EXPECT_NE(message.find(word), std::string::npos) << word << " is not in: " << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    LoadingPath, BadPath,
    ::testing::Values(
        Mistake{"empty", "", {"has no legs"}},
        Mistake{"header_only",
                "increments,strain_xx,strain_yy,strain_zz\n# nothing\n",
                {"has no legs"}},
        Mistake{"unknown_column",
                "increments,strain_xx,strain_yy,strain_zx\n",
                {":1 ", "strain_zx", "stress_xz_Pa", "nearest is strain_"}},
        Mistake{"column_twice",
                "increments,strain_xx,strain_yy,strain_zz,strain_yy\n",
                {":1 ", "strain_yy", "twice"}},
        Mistake{"no_increments", "strain_xx,strain_yy,strain_zz\n", {":1 ", "increments"}},
        Mistake{"field_missing",
                "increments,strain_xx,strain_yy,strain_zz\n\n5,0,0.1\n",
                {":3 ", "3 fields", "allowed: 4"}},
        Mistake{"field_too_many",
                "increments,strain_xx,strain_yy,strain_zz\n5,0,0.1,0,0\n",
                {":2 ", "5 fields", "allowed: 4"}},
        Mistake{"not_a_number",
                "increments,strain_xx,strain_yy,strain_zz\n5,0,0.1.2,0\n",
                {":2 ", "strain_yy", "0.1.2", "real", "hold"}},
        Mistake{"nan",
                "increments,stress_xx_Pa,strain_yy,strain_zz\n5,nan,0.1,0\n",
                {":2 ", "stress_xx_Pa", "nan"}},
        Mistake{"percent",
                "increments,strain_xx,strain_yy,strain_zz\n5,0,20,0\n",
                {":2 ", "strain_yy", "20", "-5 to 5"}},
        Mistake{"increments_zero",
                "increments,strain_xx,strain_yy,strain_zz\n0,0,0.1,0\n",
                {":2 ", "increments '0'", "1 to 10000000"}},
        Mistake{"increments_broken",
                "increments,strain_xx,strain_yy,strain_zz\n2.5,0,0.1,0\n",
                {":2 ", "2.5", "integer"}},
        Mistake{"increments_hold",
                "increments,strain_xx,strain_yy,strain_zz\nhold,0,0.1,0\n",
                {":2 ", "hold", "integer"}},
        Mistake{"increments_together",
                "increments,strain_xx,strain_yy,strain_zz\n9000000,0,0.1,0\n9000000,0,0,0\n",
                {":3 ", "18000000", "10000000"}},
        Mistake{"controlled_twice",
                "increments,strain_xx,strain_yy,strain_zz,stress_yy_Pa\n5,0,0.1,0,1e3\n",
                {":2 ", "controls yy", "strain_yy", "stress_yy_Pa"}},
        Mistake{"not_controlled",
                "increments,strain_xx,strain_yy,strain_zz\n5,0,0.1,\n",
                {":2 ", "zz", "strain_zz", "stress_zz_Pa"}}),
    [](const auto& instance) { return instance.param.name; });

TEST(LoadingPath, file_that_is_none_is_refused) {
  EXPECT_THROW(read_path_file("no such file.csv"), BadInput);
  EXPECT_THROW(read_path_file(MPM_TEST_DATA), BadInput);
}

TEST(LoadingPath, examples_run_to_their_end) {
  int examples = 0;
  const std::string directory = std::string(MPM_TEST_DATA) + "/../../input/element";
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().extension() != ".csv") continue;
    ++examples;
    SandParameters sand;
    sand.void_ratio = 0.657;
    sand.cohesion = 0.0;
    EXPECT_NO_THROW(run_element_test(
        SandLaw(sand),
        {.kind = ElementTestKind::path, .path = read_path_file(entry.path().string())}))
        << entry.path();
  }
  EXPECT_GE(examples, 4);
}

// What the point does ----------------------------------------------------------------------------

TEST(LoadingPath, has_one_row_for_the_start_and_one_for_every_increment) {
  const auto rows = follow(elastic(), 30e3,
                           "increments,strain_xx,strain_yy,strain_zz\n"
                           "4,0,0.002,0\n3,0.001,0.002,0\n");
  ASSERT_EQ(rows.size(), 8U);
  EXPECT_NEAR(rows[1].axial_strain, 0.0005, 1e-15);
  EXPECT_NEAR(rows[6].strain[0], -0.002 / 3, 1e-15);
  EXPECT_NEAR(rows[7].volumetric_strain, 0.003, 1e-15);
}

TEST(LoadingPath, targets_are_absolute_and_normal_components_compression_positive) {
  const auto rows = follow(elastic(), 30e3,
                           "increments,stress_xx_Pa,strain_yy,stress_zz_Pa,gamma_xy,stress_xz_Pa\n"
                           "5,50e3,0.003,hold,0.002,\n"
                           "6,20e3,hold,45e3,,700\n");
  const ElementTestRow& middle = rows[5];
  EXPECT_NEAR(middle.stress[0], -50e3, 1e-3);
  EXPECT_NEAR(middle.stress[2], -30e3, 1e-3);
  EXPECT_NEAR(middle.strain[1], -0.003, 1e-12);
  EXPECT_NEAR(middle.stress[3], E / (2 + 2 * nu) * 0.002, 1e-3);
  EXPECT_NEAR(middle.strain[0], (-20e3 - nu * (middle.stress[1] + 30e3)) / E, 1e-9);
  const ElementTestRow& end = rows.back();
  EXPECT_NEAR(end.stress[0], -20e3, 1e-3);
  EXPECT_NEAR(end.stress[2], -45e3, 1e-3);
  EXPECT_NEAR(end.strain[1], -0.003, 1e-12);
  EXPECT_NEAR(end.strain[3], 0.001, 1e-12);
  EXPECT_NEAR(end.strain[5], 700 * (1 + nu) / E, 1e-9);
}

SandLaw sand(double void_ratio) {
  SandParameters parameters;
  parameters.void_ratio = void_ratio;
  parameters.cohesion = 0.0;
  return SandLaw(parameters);
}

TEST(LoadingPath, standard_test_written_as_a_path_gives_the_same_curve) {
  const SandLaw law = sand(0.59);
  const auto expected = run_element_test(law, {.kind = ElementTestKind::triaxial_extension,
                                               .confining_pressure = 70e3,
                                               .strain_end = 0.12,
                                               .increments = 60});
  const auto rows = follow(law, 70e3,
                           "increments,strain_yy,stress_xx_Pa,stress_zz_Pa\n"
                           "60,-0.12,70e3,70e3\n");
  ASSERT_EQ(rows.size(), expected.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_NEAR(rows[k].q, expected[k].q, 1e-3) << k;
    EXPECT_NEAR(rows[k].volumetric_strain, expected[k].volumetric_strain, 1e-9) << k;
  }
}

TEST(LoadingPath, unloading_by_stress_beyond_the_peak_is_elastic_and_comes_back_to_the_curve) {
  const SandLaw law = sand(0.551);
  const std::string header = "increments,strain_yy,stress_yy_Pa,stress_xx_Pa,stress_zz_Pa\n";
  const auto straight = follow(law, 150e3, header + "100,0.1,,hold,hold\n");
  const auto rows =
      follow(law, 150e3, header + "80,0.08,,hold,hold\n10,,155000,hold,hold\n40,0.1,,hold,hold\n");
  ASSERT_GT(rows[55].q, 1.02 * rows[80].q) << "not beyond the peak";
  EXPECT_NEAR(rows[90].q, 5e3, 1.0);
  EXPECT_GT(rows[90].axial_strain, 0.07) << "it softened instead of unloading";
  EXPECT_LT(rows[90].axial_strain, 0.08);
  EXPECT_NEAR(rows.back().q, straight.back().q, 2e-3 * straight.back().q);
}

TEST(LoadingPath, undrained_loose_sand_loses_pressure_and_dense_sand_gains_it) {
  const std::string undrained = "increments,strain_yy,strain_xx,strain_zz\n120,0.12,-0.06,-0.06\n";
  const auto loose = follow(sand(0.83), 150e3, undrained);
  const auto dense = follow(sand(0.551), 150e3, undrained);
  EXPECT_LT(loose.back().p, 0.5 * 150e3);
  EXPECT_GT(dense.back().p, 3.0 * 150e3);
  EXPECT_NEAR(loose.back().volumetric_strain, 0.0, 1e-14);
  EXPECT_NEAR(loose.back().void_ratio, 0.83, 1e-12);
}

TEST(LoadingPath, stress_that_the_sand_cannot_carry_is_reported_with_leg_and_increment) {
  try {
    follow(sand(0.657), 100e3,
           "increments,stress_xx_Pa,stress_yy_Pa,stress_zz_Pa\n"
           "4,hold,200e3,hold\n10,hold,700e3,hold\n");
    FAIL() << "carried";
  } catch (const NumericalFailure& failure) {
    const std::string message = failure.what();
    EXPECT_NE(message.find("path.csv:3, increment"), std::string::npos) << message;
    EXPECT_NE(message.find("of 10"), std::string::npos) << message;
  }
}

TEST(ElementTest, refuses_a_pressure_under_which_the_material_does_not_rest) {
  EXPECT_THROW(run_element_test(sand(0.6), {.confining_pressure = 0.0}), BadInput);
  EXPECT_THROW(run_element_test(sand(0.6), {.kind = ElementTestKind::path}), BadInput);
  SandParameters cohesive;
  EXPECT_NO_THROW(run_element_test(
      SandLaw(cohesive), {.confining_pressure = 0.0, .strain_end = 0.01, .increments = 3}));
}

TEST(ElementTest, unconfined_compression_of_an_elastic_body_starts_without_stress) {
  const auto rows = run_element_test(
      elastic(), {.confining_pressure = 0.0, .strain_end = 0.004, .increments = 3});
  EXPECT_NEAR(rows.back().q, 0.004 * E, 1e-4);
  EXPECT_NEAR(rows.back().p, 0.004 * E / 3, 1e-4);
}

}  // namespace
}  // namespace mpm::material
