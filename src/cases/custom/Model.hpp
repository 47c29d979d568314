#pragma once

#include "Bodies.hpp"
#include "Ways.hpp"
#include "mpm/cases/Ground.hpp"
#include "mpm/run/Problem.hpp"

namespace mpm::cases::custom {

/// Grid, ground, bodies and loads that the options ask for; these outlive it.
template <int dim>
class Model {
 public:
  /// Throws BadInput where the options make no sense together.
  explicit Model(const CustomOptions& options);
  Model(const Model&) = delete;
  Model& operator=(const Model&) = delete;

  solver::SimulationSetup<dim> setup() const;
  const std::vector<Body<dim>>& bodies() const { return m_bodies; }
  double smallest_density() const;  ///< kg/m^3
  double smallest_cell() const;     ///< m
  /// That no body moves into a wall. Throws BadInput.
  void check_ways() const { custom::check_ways<dim>(m_options, m_bodies, m_lines, m_walls); }
  /// None where the soil has neither weight, load nor a stress of its own.
  std::function<SymmetricTensor(const Vector<dim>&)> initial_stress() const;
  std::vector<particles::SurfacePiece<dim>> loaded_surface() const;
  /// That every region has particles, of which none is at a free wall. Collective.
  void check_filling(const solver::Simulation<dim>& simulation) const;

 private:
  std::vector<Region<dim>> make_regions();
  Region<dim> make_region(const RegionOptions& options);
  particles::Filling<dim> filling() const;
  bool is_uniform() const;
  std::optional<int> soil_at(const Vector<dim>& x) const;
  double surcharge(const Vector<dim>& x) const;
  Vector<dim> up() const;
  void check_loads() const;

  const CustomOptions& m_options;
  std::array<basis::KnotLines, dim> m_lines;
  typename grid::Walls<dim>::Kinds m_walls;
  std::vector<Body<dim>> m_bodies;
  particles::Materials m_materials;  ///< of the regions, in their order
  Ground<dim> m_ground;
};

extern template class Model<1>;
extern template class Model<2>;
extern template class Model<3>;

}  // namespace mpm::cases::custom
