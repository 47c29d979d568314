#include "mpm/io/FieldOutput.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <numeric>
#include <type_traits>

#include "mpm/io/Hdf5File.hpp"
#include "mpm/io/ResultFiles.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/petsc/Log.hpp"

namespace mpm::io {
namespace {

using particles::Field;
using particles::Role;
using particles::Shape;

/// How a shape stands in a file.
struct FileShape {
  const char* xdmf;
  int columns;
};

FileShape file_shape(Shape shape) {
  switch (shape) {
    case Shape::vector:
      return {"Vector", 3};
    case Shape::symmetric_tensor:
      return {"Matrix", SymmetricTensor::size};  // six components as stored
    case Shape::matrix:
      return {"Tensor", 9};
    default:
      return {"Scalar", 1};
  }
}

/// Column of a component in the file.
template <int dim>
std::size_t place(Shape shape, int component) {
  return static_cast<std::size_t>(shape == Shape::matrix ? 3 * (component / dim) + component % dim
                                                         : component);
}

void write_attributes(Hdf5File& file, const Moment& moment) {
  file.attribute("time_s", moment.time);
  file.attribute("step", static_cast<std::int64_t>(moment.step));
  for (const auto& [name, value] : moment.numbers) file.attribute(name, value);
}

struct XdmfArray {
  std::string name;
  std::string type;    ///< Scalar, Vector, Matrix, Tensor
  std::string number;  ///< NumberType and Precision
};

std::string data_item(const std::string& dimensions, const std::string& number,
                      const std::string& location) {
  return fmt::format("<DataItem Format=\"HDF\" Dimensions=\"{}\" {}>{}</DataItem>", dimensions,
                     number, location);
}

constexpr auto double_number = "NumberType=\"Float\" Precision=\"8\"";

template <class Value>
std::string number_of() {
  return fmt::format("NumberType=\"{}\" Precision=\"{}\"",
                     std::is_integral_v<Value> ? "Int" : "Float", sizeof(Value));
}

std::string attribute(const XdmfArray& array, const std::string& centre,
                      const std::string& dimensions, const std::string& file) {
  return fmt::format(
      "      <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n",
      array.name, array.type, centre,
      data_item(dimensions, array.number, file + ":/" + array.name));
}

std::string collection(const std::string& name, const std::string& grids) {
  return "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
         "    <Grid Name=\"" +
         name + "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n" + grids +
         "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

/// The file of a moment.
std::string file_name(const char* kind, int k) {
  return fmt::format("{}_{:06}.h5", kind, k);
}

/// How the values of a field stand in a file.
std::string number_of(Shape shape) {
  if (shape == Shape::id) return number_of<std::int64_t>();
  return shape == Shape::integer ? number_of<std::int32_t>() : number_of<float>();
}

template <int dim>
bool is_written(const Field<dim>& field) {
  return field.role != Role::state;
}

/// XDMF of the particles of one moment.
template <int dim>
std::string particle_grid(const particles::Particles<dim>& particles, const std::string& file,
                          double time) {
  const long long count = particles.global_count();
  std::string text = fmt::format(
      "    <Grid Name=\"particles\">\n      <Time Value=\"{}\"/>\n"
      "      <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" "
      "NodesPerElement=\"1\">{}</Topology>\n"
      "      <Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
      time, count,
      data_item(std::to_string(count), "NumberType=\"Int\" Precision=\"4\"",
                file + ":/connectivity"),
      data_item(fmt::format("{} 3", count), double_number, file + ":/position"));
  for (const Field<dim>& field : particles.fields().all()) {
    if (!is_written(field)) continue;
    const auto [type, columns] = file_shape(field.shape);
    const std::string dimensions =
        columns == 1 ? std::to_string(count) : fmt::format("{} {}", count, columns);
    text += attribute({field.name, type, number_of(field.shape)}, "Node", dimensions, file);
  }
  return text + "    </Grid>\n";
}

/// The nodes of a grid, slowest direction first.
template <int dim>
std::array<int, 3> shape_of(const grid::Grid<dim>& grid) {
  std::array<int, 3> shape{1, 1, 1};
  for (int d = 0; d < dim; ++d) shape[static_cast<std::size_t>(2 - d)] = grid.nodes(d).count();
  return shape;
}

template <int dim>
std::vector<double> node_line(const grid::Grid<dim>& grid, int d) {
  return d < dim ? grid.nodes(d).positions : std::vector<double>{0.0};
}

/// XDMF of the grid at one moment.
template <int dim>
std::string node_grid(const grid::Grid<dim>& grid, const std::string& file, double time) {
  const std::string shape = fmt::format("{}", fmt::join(shape_of(grid), " "));
  std::string text = fmt::format(
      "    <Grid Name=\"grid\">\n      <Time Value=\"{}\"/>\n"
      "      <Topology TopologyType=\"3DRectMesh\" Dimensions=\"{}\"/>\n"
      "      <Geometry GeometryType=\"VXVYVZ\">",
      time, shape);
  for (int d = 0; d < 3; ++d)
    text += data_item(std::to_string(node_line(grid, d).size()), double_number,
                      fmt::format("{}:/nodes_{}", file, "xyz"[d]));
  text += "</Geometry>\n" + attribute({"mass", "Scalar", double_number}, "Node", shape, file);
  for (int d = 0; d < dim; ++d)
    text += attribute({fmt::format("velocity_{}", "xyz"[d]), "Scalar", double_number}, "Node",
                      shape, file);
  return text + "    </Grid>\n";
}

/// The HDF5 file of one moment's particles.
template <int dim>
class ParticleFile {
 public:
  ParticleFile(const std::string& path, const particles::Particles<dim>& particles)
      : m_fields(particles.fields()),
        m_view(particles.view()),
        m_communicator(particles.communicator()),
        m_file(path, m_communicator) {}

  void geometry() {
    const Field<dim>& position = m_fields.named("position");
    m_file.rows(dataset(position), kept_rows<double, double>(position), 3);
    connectivity();
  }

  void field(const Field<dim>& field) {
    if (field.shape == Shape::id)
      write(field, std::vector<std::int64_t>(m_view.id, m_view.id + m_view.count));
    else if (field.shape == Shape::integer)
      write(field, rows_of<PetscInt, std::int32_t>(field));
    else
      write(field, rows_of<double, float>(field));
  }

  void finish(const Moment& moment) {
    write_attributes(m_file, moment);
    m_file.close();
  }

 private:
  static Dataset dataset(const Field<dim>& field) {
    return {field.name, field.long_name, field.unit};
  }

  template <class Stored, class Written>
  std::vector<Written> rows_of(const Field<dim>& field) const {
    return field.role == Role::derived ? derived_rows<Written>(field)
                                       : kept_rows<Stored, Written>(field);
  }
  template <class Written>
  std::vector<Written> derived_rows(const Field<dim>& field) const;
  template <class Stored, class Written>
  std::vector<Written> kept_rows(const Field<dim>& field) const;
  template <class Value>
  void write(const Field<dim>& field, const std::vector<Value>& rows) {
    m_file.rows(dataset(field), rows, file_shape(field.shape).columns);
  }
  void connectivity();

  const particles::FieldTable<dim>& m_fields;
  const particles::ParticleView<dim> m_view;
  petsc::Communicator m_communicator;
  Hdf5File m_file;
};

template <int dim>
template <class Written>
std::vector<Written> ParticleFile<dim>::derived_rows(const Field<dim>& field) const {
  std::vector<Written> rows;
  for (int p = 0; p < m_view.count; ++p)
    rows.push_back(static_cast<Written>(field.value(m_view, p)));
  return rows;
}

/// Components that the dimension leaves out are zero.
template <int dim>
template <class Stored, class Written>
std::vector<Written> ParticleFile<dim>::kept_rows(const Field<dim>& field) const {
  const auto count = static_cast<std::size_t>(m_view.count);
  const auto width = static_cast<std::size_t>(file_shape(field.shape).columns);
  const auto handle = m_fields.template handle<Stored>(field.name);
  std::vector<Written> rows(count * width, Written{});
  for (int k = 0; k < m_fields.components(field.shape); ++k) {
    const Stored* const values = m_view.column(handle, k);
    for (std::size_t p = 0; p < count; ++p)
      rows[p * width + place<dim>(field.shape, k)] = static_cast<Written>(values[p]);
  }
  return rows;
}

/// Readers show no particles without it.
template <int dim>
void ParticleFile<dim>::connectivity() {
  const long long first = m_communicator.sum_before(m_view.count);
  std::vector<std::int32_t> rows(static_cast<std::size_t>(m_view.count));
  std::iota(rows.begin(), rows.end(), static_cast<std::int32_t>(first));
  m_file.rows({"connectivity", "row of the particle, for readers that ask for cells", "1"}, rows,
              1);
}

}  // namespace

template <int dim>
FieldOutput<dim>::FieldOutput(std::string directory) : m_directory(std::move(directory)) {}

template <int dim>
void FieldOutput<dim>::write(const Moment& moment, const particles::Particles<dim>& particles,
                             const grid::Grid<dim>& grid,
                             const grid::NodalField<dim>& mass_and_momentum) {
  const petsc::Phase phase("mpm: output");
  write_particles(moment, particles);
  write_grid(moment, grid, mass_and_momentum);
  m_times.push_back(moment.time);
  write_lists(particles, grid);
}

template <int dim>
void FieldOutput<dim>::write_lists(const particles::Particles<dim>& particles,
                                   const grid::Grid<dim>& grid) const {
  std::string particle_grids, node_grids;
  for (int k = m_first; k < count(); ++k) {
    const double time = m_times[static_cast<std::size_t>(k)];
    particle_grids += particle_grid(particles, file_name("particles", k), time);
    node_grids += node_grid(grid, file_name("grid", k), time);
  }
  write_text_file(m_directory + "/particles.xdmf", collection("particles", particle_grids),
                  grid.communicator());
  write_text_file(m_directory + "/grid.xdmf", collection("grid", node_grids), grid.communicator());
}

template <int dim>
bool FieldOutput<dim>::has_files(int k) const {
  const std::filesystem::path directory(m_directory);
  std::error_code ignored;  // what cannot be seen cannot be listed
  return std::filesystem::exists(directory / file_name("particles", k), ignored) &&
         std::filesystem::exists(directory / file_name("grid", k), ignored);
}

template <int dim>
void FieldOutput<dim>::remove_later_files() const {
  for (int k = count(); has_files(k); ++k)
    for (const char* kind : {"particles", "grid"})
      remove_result(m_directory + "/" + file_name(kind, k));
  if (m_first < count()) return;
  for (const char* list : {"particles.xdmf", "grid.xdmf"}) remove_result(m_directory + "/" + list);
}

template <int dim>
int FieldOutput<dim>::go_on(const particles::Particles<dim>& particles,
                            const grid::Grid<dim>& grid) {
  const petsc::Communicator& ranks = grid.communicator();
  int first = count();
  while (ranks.is_root() && first > 0 && has_files(first - 1)) --first;
  m_first = ranks.minimum(first);
  if (ranks.is_root()) remove_later_files();
  if (m_first < count()) write_lists(particles, grid);
  return m_first;
}

template <int dim>
void FieldOutput<dim>::write_particles(const Moment& moment,
                                       const particles::Particles<dim>& particles) {
  ParticleFile<dim> file(m_directory + "/" + file_name("particles", count()), particles);
  file.geometry();
  for (const Field<dim>& field : particles.fields().all())
    if (is_written(field)) file.field(field);
  file.finish(moment);
}

/// Nodal mass and velocity on the rectilinear mesh of the nodes (Greville abscissae).
template <int dim>
void FieldOutput<dim>::write_grid(const Moment& moment, const grid::Grid<dim>& grid,
                                  const grid::NodalField<dim>& sums) {
  Hdf5File file(m_directory + "/" + file_name("grid", count()), grid.communicator());
  write_attributes(file, moment);
  Hdf5File::Block block{{1, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  for (int d = 0; d < dim; ++d) {
    block.global[2 - d] = static_cast<hsize_t>(grid.nodes(d).count());
    block.first[2 - d] = static_cast<hsize_t>(grid.recorded_nodes().begin[d]);
    block.local[2 - d] = static_cast<hsize_t>(grid.recorded_nodes().extent(d));
  }
  for (int d = 0; d < 3; ++d)
    file.rows({fmt::format("nodes_{}", "xyz"[d]),
               fmt::format("positions of the nodes along {}", "xyz"[d]), "m"},
              grid.rank() == 0 ? node_line(grid, d) : std::vector<double>{}, 1);
  const std::vector<double> mass = grid.to_record(sums.values(0));
  file.block({"mass", "mass of the node", "kg"}, mass, block);
  for (int d = 0; d < dim; ++d) {
    std::vector<double> velocity = grid.to_record(sums.values(1 + d));
    for (std::size_t I = 0; I < mass.size(); ++I)
      velocity[I] = mass[I] > 0.0 ? velocity[I] / mass[I] : 0.0;
    file.block({fmt::format("velocity_{}", "xyz"[d]),
                fmt::format("velocity of the node along {}", "xyz"[d]), "m/s"},
               velocity, block);
  }
  file.close();
}

template class FieldOutput<1>;
template class FieldOutput<2>;
template class FieldOutput<3>;

}  // namespace mpm::io
