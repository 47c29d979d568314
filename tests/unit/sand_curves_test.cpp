// Element tests against curves of other integrators, see tests/data/j2.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "mpm/material/ElementTest.hpp"
#include "mpm/material/SandLaw.hpp"
#include "support/SandParticle.hpp"

namespace mpm::material {
namespace {

struct Reference {
  const char* file;
  ElementTestKind kind;
  double pressure;
  double void_ratio;
  double cohesion = 0.0;
  void (*choose)(SandConstants&) = [](SandConstants&) {};

  SandParameters sand() const {
    SandParameters sand = sand_with(void_ratio, cohesion);
    choose(sand);
    return sand;
  }
};

std::vector<ElementTestRow> read_reference(const Reference& reference) {
  std::ifstream file(std::string(MPM_TEST_DATA) + "/j2/" + reference.file + ".csv");
  std::string line;
  std::getline(file, line);
  std::vector<ElementTestRow> rows;
  while (std::getline(file, line)) {
    std::istringstream text(line);
    std::array<double, 6> value{};
    char comma;
    for (double& number : value) text >> number >> comma;
    rows.push_back({value[0], 1e3 * value[1], 1e3 * value[2], value[3], value[4], value[5]});
  }
  return rows;
}

void expect_same_curve(const std::vector<ElementTestRow>& rows, std::size_t every,
                       const std::vector<ElementTestRow>& expected) {
  double peak = 0.0;
  for (const ElementTestRow& row : expected) peak = std::max(peak, row.q);
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const ElementTestRow& row = rows.at(every * k);
    ASSERT_NEAR(row.axial_strain, expected[k].axial_strain, 1e-9);
    EXPECT_NEAR(row.q, expected[k].q, 1e-3 * peak) << "row " << k;
    EXPECT_NEAR(row.p, expected[k].p, 1e-3 * peak) << "row " << k;
    EXPECT_NEAR(row.volumetric_strain, expected[k].volumetric_strain, 1e-5) << "row " << k;
    EXPECT_NEAR(row.void_ratio, expected[k].void_ratio, 2e-5) << "row " << k;
    EXPECT_NEAR(row.lode_angle_deg, expected[k].lode_angle_deg, 0.1) << "row " << k;
  }
}

class ReferenceCurve : public ::testing::TestWithParam<Reference> {};

TEST_P(ReferenceCurve, is_met_with_few_and_with_many_increments) {
  const Reference& reference = GetParam();
  const SandLaw law(reference.sand());
  const auto expected = read_reference(reference);
  ASSERT_EQ(expected.size(), 151U);
  for (std::size_t every : {1U, 5U, 40U}) {
    const auto rows = run_element_test(law, {.kind = reference.kind,
                                             .confining_pressure = reference.pressure,
                                             .strain_end = std::abs(expected.back().axial_strain),
                                             .increments = every * 150});
    expect_same_curve(rows, every, expected);
  }
}

using enum ElementTestKind;

void lode(SandConstants& sand) {
  sand.dilatancy = Dilatancy::lode;
  sand.c = 0.7075;
}
void lode_explicit(SandConstants& sand) {
  lode(sand);
  sand.softening = Softening::explicit_ratio;
}
void power(SandConstants& sand) {
  sand.bulk = BulkModulus::power;
  sand.bulk_xi = 0.7;
}
void lode_power(SandConstants& sand) {
  lode(sand);
  sand.bulk = BulkModulus::power;
  sand.bulk_xi = 0.3;
}
void lode_poisson(SandConstants& sand) {
  lode(sand);
  sand.bulk = BulkModulus::poisson;
  sand.poisson_ratio = 0.2;
}
/// Constants like those of Toyoura sand.
void power_line(SandConstants& sand) {
  lode_poisson(sand);
  sand.G0 = 125.0;
  sand.Mc = 1.25;
  sand.c = 0.712;
  sand.e_Gamma = 0.934;
  sand.lambda_c = 0.019;
  sand.xi = 0.7;
  sand.d0 = 0.6;
  sand.m = 3.0;
  sand.eps_r = 0.05;
}

INSTANTIATE_TEST_SUITE_P(
    SandLaw, ReferenceCurve,
    ::testing::Values(
        Reference{"triaxial_p150_e0.551", triaxial_compression, 150e3, 0.551},
        Reference{"triaxial_p150_e0.64", triaxial_compression, 150e3, 0.64},
        Reference{"triaxial_p150_e0.72", triaxial_compression, 150e3, 0.72},
        Reference{"triaxial_p500_e0.574", triaxial_compression, 500e3, 0.574},
        Reference{"triaxial_p500_e0.64", triaxial_compression, 500e3, 0.64},
        Reference{"triaxial_p500_e0.72", triaxial_compression, 500e3, 0.72},
        Reference{"plane_strain_p400_e0.581", plane_strain, 400e3, 0.581},
        Reference{"plane_strain_p50_e0.524", plane_strain, 50e3, 0.524},
        Reference{"simple_shear_constant_volume_p100_e0.657", simple_shear_constant_volume, 100e3,
                  0.657},
        Reference{"oedometer_p5_e0.657_cohesion1.67", oedometer, 5e3, 0.657, 1670},
        Reference{"lode_plane_strain_p5_e0.524", plane_strain, 5e3, 0.524, 0, lode},
        Reference{"lode_plane_strain_p50_e0.524", plane_strain, 50e3, 0.524, 0, lode},
        Reference{"lode_plane_strain_p400_e0.581", plane_strain, 400e3, 0.581, 0, lode},
        Reference{"lode_triaxial_extension_p100_e0.6", triaxial_extension, 100e3, 0.6, 0, lode},
        Reference{"explicit_lode_plane_strain_p50_e0.524", plane_strain, 50e3, 0.524, 0,
                  lode_explicit},
        Reference{"power_triaxial_p150_e0.551", triaxial_compression, 150e3, 0.551, 0, power},
        Reference{"power_lode_plane_strain_p20_e0.6", plane_strain, 20e3, 0.6, 0, lode_power},
        Reference{"poisson_lode_plane_strain_p50_e0.524", plane_strain, 50e3, 0.524, 0,
                  lode_poisson},
        Reference{"poisson_lode_simple_shear_constant_volume_p100_e0.657",
                  simple_shear_constant_volume, 100e3, 0.657, 0, lode_poisson},
        Reference{"power_line_lode_plane_strain_p98_e0.7", plane_strain, 98e3, 0.7, 0, power_line}),
    [](const auto& instance) {
      std::string name = instance.param.file;
      for (char& letter : name)
        if (letter == '.') letter = '_';
      return name;
    });

TEST(SandLaw, oedometer_curve_is_met_with_one_update_a_row) {
  const Reference reference{"oedometer_p5_e0.657_cohesion1.67", oedometer, 5e3, 0.657, 1670};
  const SandLaw law(reference.sand());
  const auto expected = read_reference(reference);
  Particle particle(law, isotropic(reference.pressure));
  for (std::size_t k = 1; k < expected.size(); ++k) {
    particle.strain_by(
        principal(0.0, expected[k - 1].axial_strain - expected[k].axial_strain, 0.0));
    EXPECT_NEAR(particle.q(), expected[k].q, 2e-3 * expected.back().q);
  }
}

}  // namespace
}  // namespace mpm::material
