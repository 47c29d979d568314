#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mpm/grid/NodalField.hpp"
#include "mpm/particles/Particles.hpp"

namespace mpm::io {

/// One moment of a run, with numbers of the scene (displacement_m, ...) as attributes.
struct Moment {
  double time = 0.0;  ///< s
  long long step = 0;
  std::vector<std::pair<std::string, double>> numbers;
};

/// Particles and grid over time: per output one HDF5 file each, and particles.xdmf and grid.xdmf
/// that join them for ParaView. Every dataset has the attributes long_name and units.
template <int dim>
class FieldOutput {
 public:
  explicit FieldOutput(std::string directory);

  /// Collective over the ranks of the grid.
  void write(const Moment& moment, const particles::Particles<dim>& particles,
             const grid::Grid<dim>& grid, const grid::NodalField<dim>& mass_and_momentum);

  int count() const { return static_cast<int>(m_particle_grids.size()); }

 private:
  std::string write_particles(const Moment& moment, const particles::Particles<dim>& particles);
  std::string write_grid(const Moment& moment, const grid::Grid<dim>& grid,
                         const grid::NodalField<dim>& mass_and_momentum);
  std::string path(const char* kind) const;

  std::string m_directory;
  std::vector<std::string> m_particle_grids, m_node_grids;  ///< XDMF of each moment
};

extern template class FieldOutput<1>;
extern template class FieldOutput<2>;
extern template class FieldOutput<3>;

}  // namespace mpm::io
