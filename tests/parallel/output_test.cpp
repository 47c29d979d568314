#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "mpm/core/Errors.hpp"
#include "mpm/io/FieldOutput.hpp"
#include "mpm/io/Hdf5File.hpp"
#include "mpm/io/OutputDirectory.hpp"
#include "mpm/io/ResultFiles.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/NeoHookean.hpp"
#include "mpm/solver/Simulation.hpp"
#include "support/Scenes.hpp"
#include "support/SharedDirectory.hpp"

namespace mpm::io {
namespace {

using particles::Field;
using particles::Role;
using test::SharedDirectory;

/// A file of this rank alone.
class ReadFile {
 public:
  explicit ReadFile(const std::string& path)
      : m_file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {
    EXPECT_GE(m_file, 0) << path;
  }
  ~ReadFile() { H5Fclose(m_file); }
  ReadFile(const ReadFile&) = delete;
  ReadFile& operator=(const ReadFile&) = delete;

  std::vector<std::string> datasets() const {
    std::vector<std::string> names;
    const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
      static_cast<std::vector<std::string>*>(list)->emplace_back(name);
      return 0;
    };
    H5Literate(m_file, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
    return names;
  }

  /// "" if there is none.
  std::string text(const std::string& dataset, const std::string& name) const {
    const hid_t id =
        H5Aopen_by_name(m_file, dataset.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    if (id < 0) return "";
    const hid_t type = H5Aget_type(id);
    std::string value(H5Tget_size(type), ' ');
    EXPECT_GE(H5Aread(id, type, value.data()), 0) << dataset;
    H5Tclose(type);
    H5Aclose(id);
    return value;
  }

  std::vector<double> numbers(const std::string& dataset) const {
    const hid_t id = H5Dopen2(m_file, dataset.c_str(), H5P_DEFAULT);
    const hid_t space = H5Dget_space(id);
    std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    EXPECT_GE(H5Dread(id, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    H5Sclose(space);
    H5Dclose(id);
    return values;
  }

 private:
  hid_t m_file;
};

/// A box that moves, under stress, with two laws of which one keeps a state.
template <int dim>
solver::Simulation<dim> moving_box() {
  auto setup = test::full_box<dim>(test::equal_lines<dim>(0.0, 1.2, 12), grid::Wall::free);
  setup.materials = {test::elastic(),
                     std::make_shared<material::NeoHookean>(material::NeoHookeanParameters{
                         .youngs_modulus = 2e5, .poisson_ratio = 0.1, .density = 1700.0})};
  setup.filling.material_at = [](const Vector<dim>& x) { return x[0] < 0.5 ? 0 : 1; };
  setup.transfer = solver::Transfer::apic;
  return solver::Simulation<dim>(setup);
}

template <int dim>
void every_dataset_says_what_it_is_and_in_which_unit() {
  const SharedDirectory directory;
  const auto simulation = moving_box<dim>();
  const auto& particles = simulation.particles();
  FieldOutput<dim>(directory.path())
      .write({}, particles, simulation.grid(), simulation.step().nodal_sums());
  if (test::world_rank() != 0) return;
  for (const char* name : {"particles_000000.h5", "grid_000000.h5"}) {
    const ReadFile file(directory.path(name));
    EXPECT_GT(file.datasets().size(), 3u);
    for (const std::string& dataset : file.datasets()) {
      EXPECT_NE(file.text(dataset, "long_name"), "") << dataset;
      EXPECT_NE(file.text(dataset, "units"), "") << dataset;
    }
  }
  const ReadFile file(directory.path("particles_000000.h5"));
  for (const Field<dim>& field : particles.fields().all()) {
    const bool is_there = field.role != Role::state || field.name == "position";
    EXPECT_EQ(file.text(field.name, "long_name"), is_there ? field.long_name : "") << field.name;
    EXPECT_EQ(file.text(field.name, "units"), is_there ? field.unit : "") << field.name;
  }
}

options::Given as_option(const std::string& directory) {
  return {"output_dir", directory, options::Given::command_line};
}

std::string refusal_of(const std::string& directory) {
  try {
    const OutputDirectory output(as_option(directory), OutputDirectory::Unlisted::none,
                                 test::world());
  } catch (const BadInput& error) {
    return error.what();
  }
  return "";
}

void write(const std::string& path, const std::string& text) {
  if (test::world_rank() == 0) std::ofstream(path) << text;
  test::world().barrier();
}

/// Nobody changes anything meanwhile.
bool exists(const std::string& path) {
  test::world().barrier();
  const bool is_there = std::filesystem::exists(path);
  test::world().barrier();
  return is_there;
}

/// What a run writes, one of it not to its end.
void write_results(const SharedDirectory& directory) {
  write_text_file(directory.path("summary.json"), "{}", test::world());
  write_text_file(directory.path("summary.json"), "{ }", test::world());  // listed once
  CsvFile(directory.path("history.csv"), {"time_s"}, test::world());
  Hdf5File(directory.path("particles_000000.h5"), test::world()).close();
  write(directory.path("history.csv.part"), "torn");
}

TEST(OutputDirectory, files_of_an_earlier_run_go_and_those_of_the_user_stay) {
  const SharedDirectory directory;
  write_results(directory);
  for (const char* name : {"particles_x.h5", "notes.txt", "input.opts", "../escaped"})
    write(directory.path(name), "mine");
  if (test::world_rank() == 0)
    std::ofstream(directory.path(list_of_results), std::ios::app) << "notes.txt\n";
  test::world().barrier();
  EXPECT_NE(refusal_of(directory.path()), "");  // no list that a run has written
  if (test::world_rank() == 0) {
    std::ofstream list(directory.path(list_of_results));
    list << "# Files that mpmsolve has written here; the next run into this directory replaces "
            "them.\nhistory.csv\nparticles_000000.h5\nsummary.json\n../escaped\nnotes.txt\n";
  }
  test::world().barrier();
  {
    OutputDirectory output(as_option(directory.path()), OutputDirectory::Unlisted::none,
                           test::world());
    EXPECT_TRUE(exists(directory.path("history.csv"))) << "before the run begins";
    const std::size_t count = output.begin_anew();
    EXPECT_EQ(count, test::world_rank() == 0 ? 3U : 0U);
  }
  for (const char* name :
       {"summary.json", "history.csv", "history.csv.part", "particles_000000.h5"})
    EXPECT_FALSE(exists(directory.path(name))) << name;
  for (const char* name : {"particles_x.h5", "notes.txt", "input.opts", "../escaped"})
    EXPECT_TRUE(exists(directory.path(name))) << name;
  test::world().barrier();
  if (test::world_rank() == 0) std::filesystem::remove(directory.path("../escaped"));
}

TEST(OutputDirectory, a_file_that_no_run_has_listed_is_not_replaced) {
  const SharedDirectory directory;
  write_results(directory);
  EXPECT_EQ(refusal_of(directory.path()), "");
  write(directory.path("particles_000007.h5"), "mine");
  EXPECT_NE(refusal_of(directory.path()).find(": particles_000007.h5;"), std::string::npos);
}

TEST(OutputDirectory, a_run_that_is_refused_leaves_no_trace) {
  const SharedDirectory directory;
  EXPECT_EQ(refusal_of(directory.path("new/deeper")), "");
  EXPECT_FALSE(exists(directory.path("new")));
  EXPECT_FALSE(exists(directory.path(list_of_results)));
}

TEST(OutputDirectory, is_of_one_run_as_long_as_that_lives) {
  const SharedDirectory directory;
  {
    const OutputDirectory output(as_option(directory.path("out")), OutputDirectory::Unlisted::none,
                                 test::world());
    EXPECT_NE(refusal_of(directory.path("out")).find("another run"), std::string::npos);
  }
  EXPECT_EQ(refusal_of(directory.path("out")), "");
}

TEST(OutputDirectory, a_run_that_goes_on_keeps_results_but_for_its_end_and_what_is_torn) {
  const SharedDirectory directory;
  write_results(directory);
  {
    OutputDirectory output(as_option(directory.path()), OutputDirectory::Unlisted::checkpoint,
                           test::world());
    output.go_on();
  }
  EXPECT_FALSE(exists(directory.path("summary.json")));
  EXPECT_FALSE(exists(directory.path("history.csv.part")));
  EXPECT_TRUE(exists(directory.path("history.csv")));
  EXPECT_TRUE(exists(directory.path("particles_000000.h5")));
}

TEST(FieldOutput, every_dataset_says_what_it_is_and_in_which_unit) {
  every_dataset_says_what_it_is_and_in_which_unit<1>();
  every_dataset_says_what_it_is_and_in_which_unit<2>();
  every_dataset_says_what_it_is_and_in_which_unit<3>();
}

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(FieldOutput, has_every_written_field_in_the_file_and_in_its_description) {
  const SharedDirectory directory;
  const auto simulation = moving_box<2>();
  const auto& particles = simulation.particles();
  FieldOutput<2>(directory.path())
      .write({}, particles, simulation.grid(), simulation.step().nodal_sums());
  if (test::world_rank() != 0) return;
  const ReadFile file(directory.path("particles_000000.h5"));
  const std::string description = text_of(directory.path("particles.xdmf"));
  for (const Field<2>& field : particles.fields().all()) {
    if (field.role == Role::state) continue;
    EXPECT_EQ(std::ranges::count(file.datasets(), field.name), 1) << field.name;
    EXPECT_NE(description.find("Attribute Name=\"" + field.name + "\""), std::string::npos)
        << field.name;
  }
}

TEST(FieldOutput, holds_the_values_of_the_particles) {
  const SharedDirectory directory;
  auto simulation = moving_box<2>();
  const SymmetricTensor stress{{-4e3, -7e3, -5e3, 1.5e3, 0.0, 0.0}};
  test::set_stress(simulation, stress);
  test::set_velocity<2>(simulation, [](const Vector<2>& x) { return Vector<2>{x[1], -0.4}; });
  FieldOutput<2>(directory.path())
      .write({}, simulation.particles(), simulation.grid(), simulation.step().nodal_sums());
  if (test::world_rank() != 0) return;
  const ReadFile file(directory.path("particles_000000.h5"));
  const auto count = static_cast<std::size_t>(simulation.particles().global_count());
  std::map<std::string, std::vector<double>> read;
  for (const std::string& dataset : file.datasets()) read[dataset] = file.numbers(dataset);
  ASSERT_EQ(read["position"].size(), 3 * count);
  ASSERT_EQ(read["stress"].size(), 6 * count);
  for (std::size_t p = 0; p < count; ++p) {
    const double* velocity = &read["velocity"][3 * p];
    EXPECT_EQ(velocity[0], static_cast<float>(read["position"][3 * p + 1]));
    EXPECT_EQ(velocity[1], -0.4F);
    EXPECT_EQ(velocity[2], 0.0);
    for (std::size_t k = 0; k < 6; ++k)
      EXPECT_EQ(read["stress"][6 * p + k], stress.components[k]) << k;
    EXPECT_NEAR(read["p"][p], 16e3 / 3.0, 1e-3);
    EXPECT_NEAR(read["q"][p], std::sqrt(7e6 + 3 * 1.5e3 * 1.5e3), 1e-3);
    const bool second = read["position"][3 * p] >= 0.5;
    EXPECT_EQ(read["material"][p], second ? 1.0 : 0.0);
    EXPECT_EQ(read["volume_ratio"][p], second ? 1.0 : 0.0);
    EXPECT_LT(read["rank"][p], test::world_size());
  }
}

}  // namespace
}  // namespace mpm::io
