#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "mpm/core/Errors.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/LinearElastic.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/material/SandLaw.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {
namespace {

constexpr double E = 3.2e6, nu = 0.23;
constexpr double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));

LinearElastic elastic() {
  return LinearElastic({.youngs_modulus = E, .poisson_ratio = nu, .density = 1870.0});
}

// Linear elasticity ------------------------------------------------------------------------------

TEST(LinearElastic, adds_hookes_law_to_the_stress_of_every_particle) {
  constexpr std::size_t size = 6;
  std::array<std::array<double, size>, 6> strain{}, stress{};
  Batch batch;
  batch.size = size;
  for (std::size_t k = 0; k < 6; ++k) {
    batch.strain_increment.component[k] = strain[k].data();
    batch.stress.component[k] = stress[k].data();
    for (std::size_t p = 0; p < size; ++p) {
      strain[k][p] = 1e-4 * static_cast<double>(7 * k + 3 * p) - 2e-3;
      stress[k][p] = 500.0 * static_cast<double>(k) - 130.0 * static_cast<double>(p);
    }
  }
  const auto before = stress;
  elastic().update_stress(batch);
  for (std::size_t p = 0; p < size; ++p) {
    const double pressure = lambda * (strain[0][p] + strain[1][p] + strain[2][p]);
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_NEAR(stress[k][p] - before[k][p], 2 * mu * strain[k][p] + (k < 3 ? pressure : 0.0),
                  1e-9);
  }
}

TEST(LinearElastic, leaves_components_alone_that_the_dimension_does_not_have) {
  double strain_xx = 0.002, stress_xx = 40.0, stress_zz = -70.0;
  Batch batch;
  batch.size = 1;
  batch.strain_increment.component[0] = &strain_xx;
  batch.stress.component[0] = &stress_xx;
  batch.stress.component[2] = &stress_zz;
  elastic().update_stress(batch);
  EXPECT_NEAR(stress_xx, 40.0 + (lambda + 2 * mu) * 0.002, 1e-9);
  EXPECT_NEAR(stress_zz, -70.0 + lambda * 0.002, 1e-9);
}

TEST(LinearElastic, knows_its_density_and_its_wave_modulus) {
  std::array<double, 2> modulus{};
  Batch batch;
  batch.size = 2;
  elastic().wave_modulus(batch, modulus);
  EXPECT_NEAR(modulus[1], E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)), 1e-6);
  EXPECT_EQ(elastic().initial_density(), 1870.0);
}

TEST(LinearElastic, finds_the_strain_of_a_stress_and_its_energy) {
  const SymmetricTensor strain{{2e-3, -1e-3, 4e-4, 7e-4, -3e-4, 5e-4}};
  const SymmetricTensor stress = elastic().stress_increment(strain);
  const SymmetricTensor found = elastic().elastic_strain(stress);
  for (int k = 0; k < SymmetricTensor::size; ++k) EXPECT_NEAR(found[k], strain[k], 1e-15);
  const double volumetric = trace(strain);
  EXPECT_NEAR(elastic().strain_energy_density(stress),
              0.5 * lambda * volumetric * volumetric + mu * contract(strain, strain), 1e-12 * E);
}

TEST(LinearElastic, has_the_strain_energy_of_every_particle_of_a_batch) {
  std::array<double, 2> xx{-3.1e3, 0.7e3}, yy{1.9e3, -2.3e3}, xy{0.4e3, 1.1e3}, energy{};
  Batch batch;
  batch.size = 2;
  batch.stress.component = {xx.data(), yy.data(), nullptr, xy.data()};
  ASSERT_TRUE(elastic().has_strain_energy());
  elastic().strain_energy_density(batch, energy);
  const double K = E / (3 * (1 - 2 * nu));
  for (std::size_t p = 0; p < 2; ++p) {
    const double mean = (xx[p] + yy[p]) / 3;
    const SymmetricTensor s{{xx[p] - mean, yy[p] - mean, -mean, xy[p]}};
    EXPECT_NEAR(energy[p], mean * mean / (2 * K) + contract(s, s) / (4 * mu), 1e-12 * E);
  }
}

TEST(LinearElastic, refuses_constants_without_a_stable_material) {
  EXPECT_THROW(LinearElastic({.youngs_modulus = 0.0}), BadInput);
  EXPECT_THROW(LinearElastic({.poisson_ratio = 0.5}), BadInput);
  EXPECT_THROW(LinearElastic({.poisson_ratio = -1.0}), BadInput);
  EXPECT_THROW(LinearElastic({.density = -3.0}), BadInput);
}

// Element tests ----------------------------------------------------------------------------------

using enum ElementTestKind;
constexpr double confining = 35e3, strain_end = 0.03;

std::vector<ElementTestRow> elastic_rows(ElementTestKind kind) {
  return run_element_test(
      elastic(),
      {.kind = kind, .confining_pressure = confining, .strain_end = strain_end, .increments = 12});
}

TEST(ElementTest, starts_with_the_isotropic_state) {
  const auto rows = elastic_rows(plane_strain);
  ASSERT_EQ(rows.size(), 13U);
  EXPECT_EQ(rows[0].axial_strain, 0.0);
  EXPECT_EQ(rows[0].q, 0.0);
  EXPECT_NEAR(rows[0].p, confining, 1e-9);
  EXPECT_EQ(rows[0].lode_angle_deg, 0.0);
}

TEST(ElementTest, triaxial_compression_of_an_elastic_body_is_uniaxial) {
  const auto row = elastic_rows(triaxial_compression)[6];
  EXPECT_NEAR(row.axial_strain, 0.5 * strain_end, 1e-12);
  EXPECT_NEAR(row.q, E * 0.5 * strain_end, 1e-3);
  EXPECT_NEAR(row.p, confining + E * 0.5 * strain_end / 3, 1e-3);
  EXPECT_NEAR(row.volumetric_strain, (1 - 2 * nu) * 0.5 * strain_end, 1e-9);
  EXPECT_NEAR(row.lode_angle_deg, -30.0, 1e-3);
}

TEST(ElementTest, triaxial_extension_stretches_the_axis) {
  const auto row = elastic_rows(triaxial_extension).back();
  EXPECT_NEAR(row.axial_strain, -strain_end, 1e-12);
  EXPECT_NEAR(row.q, E * strain_end, 1e-3);
  EXPECT_NEAR(row.volumetric_strain, -(1 - 2 * nu) * strain_end, 1e-9);
  EXPECT_NEAR(row.lode_angle_deg, 30.0, 1e-3);
}

TEST(ElementTest, plane_strain_holds_the_lateral_stress_and_the_thickness) {
  const auto row = elastic_rows(plane_strain).back();
  const double axial = E * strain_end / (1 - nu * nu);
  EXPECT_NEAR(row.p, confining + (1 + nu) * axial / 3, 1e-3);
  EXPECT_NEAR(row.q, axial * std::sqrt(1 - nu + nu * nu), 1e-3);
  EXPECT_NEAR(row.volumetric_strain, strain_end * (1 - nu / (1 - nu)), 1e-9);
}

TEST(ElementTest, oedometer_holds_the_sides) {
  const auto row = elastic_rows(oedometer).back();
  EXPECT_NEAR(row.volumetric_strain, strain_end, 1e-12);
  EXPECT_NEAR(row.p, confining + (lambda + 2 * mu / 3) * strain_end, 1e-6);
  EXPECT_NEAR(row.q, 2 * mu * strain_end, 1e-6);
}

TEST(ElementTest, simple_shear_takes_the_engineering_strain_without_volume_change) {
  const auto row = elastic_rows(simple_shear_constant_volume).back();
  EXPECT_NEAR(row.axial_strain, strain_end, 1e-12);
  EXPECT_NEAR(row.volumetric_strain, 0.0, 1e-15);
  EXPECT_NEAR(row.q, std::sqrt(3.0) * mu * strain_end, 1e-6);
  EXPECT_NEAR(row.lode_angle_deg, 0.0, 1e-6);
}

TEST(ElementTest, mixed_path_reaches_the_prescribed_stresses_and_strains) {
  const LinearElastic material = elastic();
  MaterialPoint point(material, confining);
  MixedIncrement increment;
  increment.control = {Control::stress, Control::strain, Control::stress,
                       Control::stress, Control::strain, Control::strain};
  increment.change = {{-4e3, -0.002, 1.5e3, 700.0, 3e-4, 0.0}};
  point.apply(increment);
  EXPECT_NEAR(point.stress()[0], -confining - 4e3, 1e-3);
  EXPECT_NEAR(point.strain()[1], -0.002, 1e-12);
  EXPECT_NEAR(point.stress()[2], -confining + 1.5e3, 1e-3);
  EXPECT_NEAR(point.stress()[3], 700.0, 1e-3);
  EXPECT_NEAR(point.strain()[3], 700.0 / (2 * mu), 1e-9);
  EXPECT_NEAR(point.strain()[0], (-4e3 - nu * (point.stress()[1] + confining + 1.5e3)) / E, 1e-8);
}

TEST(ElementTest, stress_path_of_sand_inside_its_surface_follows_the_swelling_line) {
  SandParameters sand;
  sand.void_ratio = 0.61;
  sand.cohesion = 0.0;
  const SandLaw law(sand);
  MaterialPoint point(law, 90e3);
  MixedIncrement swelling;
  swelling.control.fill(Control::stress);
  swelling.change = {{60e3, 60e3, 60e3, 0, 0, 0}};
  point.apply(swelling);
  EXPECT_NEAR(trace(point.strain()), sand.kappa / 1.61 * std::log(3.0), 1e-6);
  EXPECT_NEAR(*point.state("void_ratio"), 1.61 * std::exp(trace(point.strain())) - 1.0, 1e-12);
}

TEST(ElementTest, stops_where_no_strain_gives_the_prescribed_stress) {
  SandParameters sand;
  const SandLaw law(sand);
  MaterialPoint point(law, 20e3);
  MixedIncrement pull;
  pull.control.fill(Control::stress);
  pull.change = {{-60e3, 15e3, 15e3, 0, 0, 0}};
  EXPECT_THROW(point.apply(pull), NumericalFailure);
}

TEST(ElementTest, refuses_settings_that_make_no_sense) {
  EXPECT_THROW(run_element_test(elastic(), {.confining_pressure = -1.0}), BadInput);
  EXPECT_THROW(run_element_test(elastic(), {.strain_end = 0.0}), BadInput);
  EXPECT_THROW(run_element_test(elastic(), {.increments = 0}), BadInput);
}

// The table and the options ----------------------------------------------------------------------

std::unique_ptr<MaterialFactory> factory_of(std::string_view name) {
  for (const MaterialKind& kind : material_kinds())
    if (kind.name == name) return kind.make_factory();
  throw BadInput("no such law");
}

TEST(MaterialKinds, every_law_has_the_name_that_it_is_chosen_by) {
  for (const MaterialKind& kind : material_kinds())
    EXPECT_EQ(kind.make_factory()->create()->name(), kind.name);
}

TEST(MaterialKinds, every_law_is_created_from_its_defaults) {
  for (const MaterialKind& kind : material_kinds()) {
    options::OptionSet set;
    const auto factory = kind.make_factory();
    factory->declare(set);
    EXPECT_GT(factory->create()->initial_density(), 0.0) << kind.name;
  }
}

TEST(SandFactory, builds_the_law_that_the_options_describe) {
  options::OptionSet set;
  const auto factory = factory_of("sand");
  factory->declare(set);
  const std::vector<options::Given> given{
      {"sand", "stockton_paper", "test"},  {"sand_void_ratio", "0.7", "test"},
      {"sand_Gs", "2.5", "test"},          {"sand_cohesion", "300", "test"},
      {"sand_softening", "plain", "test"}, {"sand_xi", "0.6", "test"}};
  set.assign(given);
  const auto material = factory->create();
  EXPECT_NEAR(material->initial_density(), 2500.0 / 1.7, 1e-9);

  SandParameters expected;
  expected.void_ratio = 0.7;
  expected.softening = Softening::plain;
  expected.xi = 0.6;
  const SurfaceState y{40e3, 0.68, 0.04, -0.2};
  const auto& law = dynamic_cast<const SandLaw&>(*material);
  EXPECT_EQ(law.surface().at(y).qhat, LoadingSurface(expected).at(y).qhat);
  EXPECT_NEAR(law.invariants({}).p_star, 300.0, 1e-9);
}

TEST(SandFactory, takes_the_defaults_of_a_scene) {
  options::OptionSet set;
  SandFactory factory;
  factory.parameters().cohesion = 0.0;
  factory.declare(set);
  set.assign({});
  EXPECT_EQ(dynamic_cast<const SandLaw&>(*factory.create()).invariants({}).p_star, 0.0);
}

TEST(SandFactory, refuses_constants_that_do_not_go_together) {
  options::OptionSet set;
  const auto factory = factory_of("sand");
  factory->declare(set);
  const std::vector<options::Given> given{{"sand_d0", "1.3", "test"}};
  EXPECT_THROW(set.assign(given), BadInput);
}

/// The sand of a factory after these options, for a scene with dense sand of 250 Pa cohesion.
SandParameters sand_after(const std::vector<options::Given>& given) {
  options::OptionSet set;
  SandFactory factory;
  factory.parameters().void_ratio = 0.524;
  factory.parameters().cohesion = 250.0;
  factory.declare(set);
  set.assign(given);
  return factory.parameters();
}

TEST(SandFactory, a_name_stands_for_constants_and_single_ones_override_it_in_any_order) {
  const SandParameters sand = sand_after(
      {{"sand_m", "3.3", "test"}, {"sand", "toyoura", "test"}, {"sand_Gs", "2.7", "test"}});
  EXPECT_EQ(sand.m, 3.3);
  EXPECT_EQ(sand.Gs, 2.7);
  EXPECT_EQ(sand.e_max, 0.977);
  EXPECT_EQ(sand.dilatancy, Dilatancy::lode);
  EXPECT_EQ(sand.cohesion, 250.0);
}

TEST(SandFactory, the_paper_s_sand_is_table_1_with_the_equations_as_printed) {
  const SandParameters sand = sand_after({{"sand", "stockton_paper", "test"}});
  EXPECT_EQ(sand.void_ratio, 0.524);
  EXPECT_EQ(sand.c, 0.75);
  EXPECT_EQ(sand.dilatancy, Dilatancy::printed);
  EXPECT_EQ(sand.bulk, BulkModulus::log);
}

TEST(SandFactory, a_scene_s_relative_density_stays_when_the_sand_is_another_one) {
  const double dense = sand_after({}).void_ratio;
  EXPECT_EQ(dense, 0.524);
  const SandParameters toyoura = sand_after({{"sand", "toyoura", "test"}});
  EXPECT_NEAR(relative_density(toyoura), (0.778 - 0.524) / (0.778 - 0.497), 1e-12);
  EXPECT_EQ(
      sand_after({{"sand", "toyoura", "test"}, {"sand_void_ratio", "0.7", "test"}}).void_ratio,
      0.7);
}

TEST(SandFactory, packing_is_given_by_void_ratio_or_relative_density) {
  EXPECT_NEAR(sand_after({{"sand_relative_density", "0.4", "test"}}).void_ratio,
              0.778 - 0.4 * (0.778 - 0.497), 1e-12);
  EXPECT_THROW(sand_after({{"sand_relative_density", "0.4", "a file"},
                           {"sand_void_ratio", "0.6", "a file"}}),
               BadInput);
  EXPECT_NEAR(sand_after({{"sand_void_ratio", "0.6", "a file"},
                          {"sand_relative_density", "0.4", "command line"}})
                  .void_ratio,
              0.6656, 1e-12);
}

TEST(SandFactory, refuses_constants_that_the_chosen_bulk_modulus_does_not_read) {
  EXPECT_THROW(sand_after({{"sand_poisson", "0.25", "test"}, {"sand_bulk", "log", "test"}}),
               BadInput);
  EXPECT_THROW(sand_after({{"sand_bulk_xi", "0.3", "test"}, {"sand_bulk", "poisson", "test"}}),
               BadInput);
  EXPECT_THROW(sand_after({{"sand_kappa", "0.01", "test"}, {"sand_bulk", "poisson", "test"}}),
               BadInput);
  EXPECT_EQ(sand_after({{"sand_bulk_xi", "0.3", "test"}, {"sand_bulk", "power", "test"}}).bulk_xi,
            0.3);
}

TEST(SandFactory, what_a_run_has_used_is_accepted_again) {
  options::OptionSet set;
  SandFactory factory;
  factory.declare(set);
  set.assign(std::vector<options::Given>{{"sand", "toyoura", "test"},
                                         {"sand_bulk", "poisson", "test"},
                                         {"sand_relative_density", "0.6", "test"}});
  std::vector<options::Given> used;
  for (const auto& [name, value] : set.values())
    if (!value.empty()) used.push_back({name, value, "used.opts"});
  EXPECT_EQ(sand_after(used).void_ratio, factory.parameters().void_ratio);
}

TEST(SandFactory, refuses_a_lode_angle_dependence_that_is_not_one_in_compression) {
  options::OptionSet set;
  const auto factory = factory_of("sand");
  factory->declare(set);
  const std::vector<options::Given> given{{"sand_c", "0.41", "test"}};
  EXPECT_THROW(set.assign(given), BadInput);
}

TEST(SandParameters, derived_constants_are_those_of_stockton_beach_sand) {
  SandParameters sand;
  EXPECT_NEAR(critical_friction_angle(sand) * 180.0 / 3.14159265, 30.91, 0.01);
  EXPECT_NEAR(relative_density(sand), 0.904, 1e-3);
  sand.void_ratio = 0.657;
  EXPECT_NEAR(relative_density(sand), 0.431, 1e-3);
}

}  // namespace
}  // namespace mpm::material
