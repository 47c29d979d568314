#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mpm/core/Archive.hpp"
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

  /// Moments so far.
  int count() const { return static_cast<int>(m_times.size()); }
  void persist(Archive& archive) { archive("times", m_times); }
  /// Goes on after the moments that have been put back: removes files of later ones that are in the
  /// directory, and lists only earlier ones whose files are there. Returns the first that is.
  /// Collective.
  int go_on(const particles::Particles<dim>& particles, const grid::Grid<dim>& grid);

 private:
  void write_particles(const Moment& moment, const particles::Particles<dim>& particles);
  void write_grid(const Moment& moment, const grid::Grid<dim>& grid,
                  const grid::NodalField<dim>& mass_and_momentum);
  /// The files that join the moments.
  void write_lists(const particles::Particles<dim>& particles, const grid::Grid<dim>& grid) const;
  bool has_files(int k) const;
  void remove_later_files() const;

  std::string m_directory;
  std::vector<double> m_times;  ///< of each moment, s
  int m_first = 0;              ///< that has files here
};

extern template class FieldOutput<1>;
extern template class FieldOutput<2>;
extern template class FieldOutput<3>;

}  // namespace mpm::io
