#pragma once

#include <array>
#include <memory>
#include <vector>

#include "mpm/basis/BSpline.hpp"
#include "mpm/core/Archive.hpp"
#include "mpm/grid/NodalField.hpp"
#include "mpm/grid/Walls.hpp"
#include "mpm/particles/Particles.hpp"
#include "mpm/transfer/StateIncrements.hpp"

namespace mpm::solver {

/// Over which length, and how often, softening is averaged.
struct RegularisationOptions {
  double length = 0.0;  ///< L, m; 0: not at all
  int every = 20;       ///< steps

  bool is_on() const { return length > 0.0; }
};

/// Lines of the averaging grid in one direction of a grid with the given lines. Where it has walls
/// at both ends the spacing is the nearest to L that divides it; else it is L, from the one wall or
/// to both sides of the middle, and ends at or beyond the lines. Throws BadInput where L is shorter
/// than two cells or walls are too close for it.
basis::KnotLines averaging_lines(const basis::KnotLines& lines,
                                 const std::array<grid::Wall, 2>& walls, double L);

/// Averages over a length L what softens: every few steps the increments dx_p of the state
/// variables whose role is softening are replaced by
///
///     dx_p <- sum_I N_Ip dx_I,  dx_I = sum_p V_p N_Ip dx_p / sum_p V_p N_Ip,
///
/// N cubic B-splines on equal cells of L, whatever the cells of the grid: a kernel with a standard
/// deviation of sqrt(2/3) L. Folded at walls like mass, so that a constant stays one. Keeps
/// sum_p V_p dx_p. Every rank has the whole averaging grid, which is small.
template <int dim>
class Regularisation {
 public:
  /// `particles` must have the columns of OptionalColumns::softening_before and outlive this.
  /// Throws BadInput as averaging_lines does and where no law softens. Collective.
  Regularisation(const RegularisationOptions& options,
                 const std::array<basis::KnotLines, dim>& lines,
                 const typename grid::Walls<dim>::Kinds& walls,
                 particles::Particles<dim>& particles);

  /// Before a step: keeps the values from which the next increments count, where that is due.
  /// Local.
  void begin_step();
  /// After a step, particles where they belong: averages where that is due. Collective.
  void end_step();

  void persist(Archive& archive) { archive("steps", m_steps); }

 private:
  struct Softening {
    particles::StateHandle now, before;
    int number;  ///< of the variable, which laws may share
  };

  std::vector<std::vector<Softening>> find_softening(double L);
  std::vector<Softening> softening_of(int material);
  void average(const particles::ParticleView<dim>& view);
  std::vector<transfer::AveragedState> states(const particles::ParticleView<dim>& view,
                                              int material);
  template <class Visit>
  void for_each_material(const Visit& visit) const;

  int m_every;
  int m_steps = 0;  ///< since the last averaging
  particles::Particles<dim>& m_particles;
  std::vector<std::string> m_names;                 ///< of all softening variables
  std::vector<std::vector<Softening>> m_softening;  ///< of every material
  std::array<basis::BSpline<3>, dim> m_bases;
  std::unique_ptr<grid::Grid<dim>> m_grid;
  grid::Walls<dim> m_walls;
  std::unique_ptr<grid::NodalField<dim>> m_sums;  ///< volume and increment of every variable
};

extern template class Regularisation<1>;
extern template class Regularisation<2>;
extern template class Regularisation<3>;

}  // namespace mpm::solver
