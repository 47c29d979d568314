#include "mpm/io/FieldOutput.hpp"

#include <fmt/format.h>

#include <numeric>
#include <type_traits>

#include "mpm/io/Hdf5File.hpp"
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

std::string collection(const std::string& name, const std::vector<std::string>& grids) {
  std::string text =
      "<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
      "    <Grid Name=\"" +
      name + "\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (const std::string& grid : grids) text += grid;
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

/// The HDF5 file of one moment's particles and, beside it, the XDMF that describes it.
template <int dim>
class ParticleFile {
 public:
  ParticleFile(const std::string& directory, std::string name,
               const particles::Particles<dim>& particles)
      : m_name(std::move(name)),
        m_fields(particles.fields()),
        m_view(particles.view()),
        m_count(particles.global_count()),
        m_communicator(particles.communicator()),
        m_file(directory + "/" + m_name, m_communicator) {}

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

  /// Closes the file; returns the XDMF grid.
  std::string finish(const Moment& moment) {
    write_attributes(m_file, moment);
    m_file.close();
    return fmt::format(
        "    <Grid Name=\"particles\">\n      <Time Value=\"{}\"/>\n"
        "      <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" "
        "NodesPerElement=\"1\">{}</Topology>\n"
        "      <Geometry GeometryType=\"XYZ\">{}</Geometry>\n{}    </Grid>\n",
        moment.time, m_count,
        data_item(std::to_string(m_count), "NumberType=\"Int\" Precision=\"4\"",
                  m_name + ":/connectivity"),
        data_item(fmt::format("{} 3", m_count), double_number, m_name + ":/position"),
        m_attributes);
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
  void write(const Field<dim>& field, const std::vector<Value>& rows);
  void connectivity();

  std::string m_name;
  const particles::FieldTable<dim>& m_fields;
  const particles::ParticleView<dim> m_view;
  long long m_count;  ///< of all ranks
  petsc::Communicator m_communicator;
  Hdf5File m_file;
  std::string m_attributes;
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

template <int dim>
template <class Value>
void ParticleFile<dim>::write(const Field<dim>& field, const std::vector<Value>& rows) {
  const auto [type, columns] = file_shape(field.shape);
  m_file.rows(dataset(field), rows, columns);
  const std::string dimensions =
      columns == 1 ? std::to_string(m_count) : fmt::format("{} {}", m_count, columns);
  m_attributes += attribute({field.name, type, number_of<Value>()}, "Node", dimensions, m_name);
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
std::string FieldOutput<dim>::path(const char* kind) const {
  return fmt::format("{}_{:06}.h5", kind, count());
}

template <int dim>
void FieldOutput<dim>::write(const Moment& moment, const particles::Particles<dim>& particles,
                             const grid::Grid<dim>& grid,
                             const grid::NodalField<dim>& mass_and_momentum) {
  const petsc::Phase phase("mpm: output");
  const std::string particle_grid = write_particles(moment, particles);
  const std::string node_grid = write_grid(moment, grid, mass_and_momentum);
  m_particle_grids.push_back(particle_grid);
  m_node_grids.push_back(node_grid);
  write_text_file(m_directory + "/particles.xdmf", collection("particles", m_particle_grids),
                  grid.communicator());
  write_text_file(m_directory + "/grid.xdmf", collection("grid", m_node_grids),
                  grid.communicator());
}

template <int dim>
std::string FieldOutput<dim>::write_particles(const Moment& moment,
                                              const particles::Particles<dim>& particles) {
  ParticleFile<dim> file(m_directory, path("particles"), particles);
  file.geometry();
  for (const Field<dim>& field : particles.fields().all())
    if (field.role != Role::state) file.field(field);
  return file.finish(moment);
}

/// Nodal mass and velocity on the rectilinear mesh of the nodes (Greville abscissae).
template <int dim>
std::string FieldOutput<dim>::write_grid(const Moment& moment, const grid::Grid<dim>& grid,
                                         const grid::NodalField<dim>& sums) {
  const std::string name = path("grid");
  Hdf5File file(m_directory + "/" + name, grid.communicator());
  write_attributes(file, moment);
  Hdf5File::Block block{{1, 1, 1}, {0, 0, 0}, {1, 1, 1}};
  for (int d = 0; d < dim; ++d) {
    block.global[2 - d] = static_cast<hsize_t>(grid.nodes(d).count());
    block.first[2 - d] = static_cast<hsize_t>(grid.recorded_nodes().begin[d]);
    block.local[2 - d] = static_cast<hsize_t>(grid.recorded_nodes().extent(d));
  }
  const std::string shape =
      fmt::format("{} {} {}", block.global[0], block.global[1], block.global[2]);
  std::string xdmf = fmt::format(
      "    <Grid Name=\"grid\">\n      <Time Value=\"{}\"/>\n"
      "      <Topology TopologyType=\"3DRectMesh\" Dimensions=\"{}\"/>\n"
      "      <Geometry GeometryType=\"VXVYVZ\">",
      moment.time, shape);
  for (int d = 0; d < 3; ++d) {
    const std::vector<double> line = d < dim ? grid.nodes(d).positions : std::vector<double>{0.0};
    const Dataset dataset{fmt::format("nodes_{}", "xyz"[d]),
                          fmt::format("positions of the nodes along {}", "xyz"[d]), "m"};
    file.rows(dataset, grid.rank() == 0 ? line : std::vector<double>{}, 1);
    xdmf += data_item(std::to_string(line.size()), double_number, name + ":/" + dataset.name);
  }
  xdmf += "</Geometry>\n";
  auto write = [&](const Dataset& dataset, const std::vector<double>& values) {
    file.block(dataset, values, block);
    xdmf += attribute({dataset.name, "Scalar", double_number}, "Node", shape, name);
  };
  const std::vector<double> mass = grid.to_record(sums.values(0));
  write({"mass", "mass of the node", "kg"}, mass);
  for (int d = 0; d < dim; ++d) {
    std::vector<double> velocity = grid.to_record(sums.values(1 + d));
    for (std::size_t I = 0; I < mass.size(); ++I)
      velocity[I] = mass[I] > 0.0 ? velocity[I] / mass[I] : 0.0;
    write({fmt::format("velocity_{}", "xyz"[d]),
           fmt::format("velocity of the node along {}", "xyz"[d]), "m/s"},
          velocity);
  }
  file.close();
  return xdmf + "    </Grid>\n";
}

template class FieldOutput<1>;
template class FieldOutput<2>;
template class FieldOutput<3>;

}  // namespace mpm::io
