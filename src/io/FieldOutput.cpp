#include "mpm/io/FieldOutput.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "mpm/io/Hdf5File.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/petsc/Log.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::io {
namespace {

/// N x 3 from the components that the dimension has, the rest zero.
template <int dim>
std::vector<double> as_vectors(const std::array<double*, dim>& components, int count) {
  std::vector<double> rows(static_cast<std::size_t>(3 * count), 0.0);
  for (int p = 0; p < count; ++p)
    for (int d = 0; d < dim; ++d) rows[static_cast<std::size_t>(3 * p + d)] = components[d][p];
  return rows;
}

std::vector<float> to_float(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

/// Stress as xx yy zz xy yz xz, with p and q (compression positive).
struct StressOutput {
  std::vector<float> stress, p, q;
};

template <int dim>
StressOutput stress_output(const particles::ParticleView<dim>& view) {
  StressOutput output;
  for (int p = 0; p < view.count; ++p) {
    SymmetricTensor stress;
    for (int k = 0; k < tensor_components<dim>; ++k) stress[k] = view.stress[k][p];
    for (int k = 0; k < SymmetricTensor::size; ++k)
      output.stress.push_back(static_cast<float>(stress[k]));
    output.p.push_back(static_cast<float>(-trace(stress) / 3.0));
    output.q.push_back(static_cast<float>(std::sqrt(1.5) * norm(deviator(stress))));
  }
  return output;
}

void write_attributes(Hdf5File& file, const Moment& moment) {
  file.attribute("time_s", moment.time);
  file.attribute("step", static_cast<std::int64_t>(moment.step));
  for (const auto& [name, value] : moment.numbers) file.attribute(name, value);
}

struct XdmfArray {
  std::string name;
  std::string type;    ///< Scalar, Vector, Matrix (six components as stored)
  std::string number;  ///< NumberType and Precision
  int columns;
};

std::string data_item(const std::string& dimensions, const std::string& number,
                      const std::string& location) {
  return fmt::format("<DataItem Format=\"HDF\" Dimensions=\"{}\" {}>{}</DataItem>", dimensions,
                     number, location);
}

constexpr auto float_number = "NumberType=\"Float\" Precision=\"4\"";
constexpr auto double_number = "NumberType=\"Float\" Precision=\"8\"";

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
class ParticleFile {
 public:
  ParticleFile(const std::string& directory, std::string name, long long global_count)
      : m_name(std::move(name)), m_count(global_count), m_file(directory + "/" + m_name) {}

  /// Readers show no particles without explicit connectivity.
  void geometry(const std::vector<double>& positions) {
    m_file.rows("position", positions, 3);
    const auto local = static_cast<long long>(positions.size() / 3);
    long long up_to_here = local;
    MPI_Scan(MPI_IN_PLACE, &up_to_here, 1, MPI_LONG_LONG, MPI_SUM, PETSC_COMM_WORLD);
    std::vector<std::int32_t> connectivity(static_cast<std::size_t>(local));
    std::iota(connectivity.begin(), connectivity.end(),
              static_cast<std::int32_t>(up_to_here - local));
    m_file.rows("connectivity", connectivity, 1);
  }
  void scalar(const std::string& name, const std::vector<float>& values) {
    m_file.rows(name, values, 1);
    describe({name, "Scalar", float_number, 1});
  }
  void vector(const std::string& name, const std::vector<double>& rows) {
    m_file.rows(name, to_float(rows), 3);
    describe({name, "Vector", float_number, 3});
  }
  void tensor(const std::string& name, const std::vector<float>& rows) {
    m_file.rows(name, rows, SymmetricTensor::size);
    describe({name, "Matrix", float_number, SymmetricTensor::size});
  }
  template <class Integer>
  void integers(const std::string& name, const std::vector<Integer>& values) {
    m_file.rows(name, values, 1);
    describe(
        {name, "Scalar", fmt::format("NumberType=\"Int\" Precision=\"{}\"", sizeof(Integer)), 1});
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
  void describe(const XdmfArray& array) {
    const std::string shape =
        array.columns == 1 ? std::to_string(m_count) : fmt::format("{} {}", m_count, array.columns);
    m_attributes += attribute(array, "Node", shape, m_name);
  }

  std::string m_name;
  long long m_count;
  Hdf5File m_file;
  std::string m_attributes;
};

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
  write_text_file(m_directory + "/particles.xdmf", collection("particles", m_particle_grids));
  write_text_file(m_directory + "/grid.xdmf", collection("grid", m_node_grids));
}

template <int dim>
std::string FieldOutput<dim>::write_particles(const Moment& moment,
                                              const particles::Particles<dim>& particles) {
  const particles::ParticleView<dim> view = particles.view();
  ParticleFile file(m_directory, path("particles"), particles.global_count());
  file.geometry(as_vectors<dim>(view.position, view.count));
  file.vector("velocity", as_vectors<dim>(view.velocity, view.count));
  file.vector("displacement", as_vectors<dim>(view.displacement, view.count));
  const StressOutput stress = stress_output<dim>(view);
  file.tensor("stress", stress.stress);
  file.scalar("p", stress.p);
  file.scalar("q", stress.q);
  const auto scalar = [&](const std::string& name, const double* values) {
    file.scalar(name, {values, values + view.count});
  };
  scalar("deviatoric_strain", view.deviatoric_strain);
  scalar("volume", view.volume);
  for (std::size_t s = 0; s < view.state.size(); ++s)
    scalar(particles.state_names()[s], view.state[s]);
  file.integers("id", std::vector<std::int64_t>(view.id, view.id + view.count));
  file.integers("material", std::vector<std::int32_t>(view.material, view.material + view.count));
  file.integers(
      "rank", std::vector<std::int32_t>(static_cast<std::size_t>(view.count), petsc::world_rank()));
  return file.finish(moment);
}

/// Nodal mass and velocity on the rectilinear mesh of the nodes (Greville abscissae).
template <int dim>
std::string FieldOutput<dim>::write_grid(const Moment& moment, const grid::Grid<dim>& grid,
                                         const grid::NodalField<dim>& sums) {
  const std::string name = path("grid");
  Hdf5File file(m_directory + "/" + name);
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
    const std::string dataset = fmt::format("nodes_{}", "xyz"[d]);
    file.rows(dataset, petsc::world_rank() == 0 ? line : std::vector<double>{}, 1);
    xdmf += data_item(std::to_string(line.size()), double_number, name + ":/" + dataset);
  }
  xdmf += "</Geometry>\n";
  auto write = [&](const std::string& dataset, const std::vector<double>& values) {
    file.block(dataset, values, block);
    xdmf += attribute({dataset, "Scalar", double_number, 1}, "Node", shape, name);
  };
  const std::vector<double> mass = grid.to_record(sums.values(0));
  write("mass", mass);
  for (int d = 0; d < dim; ++d) {
    std::vector<double> velocity = grid.to_record(sums.values(1 + d));
    for (std::size_t I = 0; I < mass.size(); ++I)
      velocity[I] = mass[I] > 0.0 ? velocity[I] / mass[I] : 0.0;
    write(fmt::format("velocity_{}", "xyz"[d]), velocity);
  }
  file.close();
  return xdmf + "    </Grid>\n";
}

template class FieldOutput<1>;
template class FieldOutput<2>;
template class FieldOutput<3>;

}  // namespace mpm::io
