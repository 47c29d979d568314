#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/particles/Seeding.hpp"
#include "mpm/run/Checks.hpp"
#include "mpm/run/Inertia.hpp"
#include "mpm/run/RunOptions.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::cases {

enum class Symmetry { automatic, half, full };
enum class Geostatic { prescribed };

/// Options of the pipe scene and what follows from them. The surface is at y = 0, the pipe's axis
/// at x = 0, y = -H.
struct PipeOptions {
  run::RunOptions run;
  material::SandFactory sand;
  run::Checks checks;

  double diameter = 0.0375;        ///< m
  double embedment_ratio = 3.0;    ///< H/D
  std::optional<double> velocity;  ///< m/s
  double inertia_tolerance = 0.02;
  double end_displacement = 0.9;  ///< u/D
  double ramp_distance = 0.02;    ///< u/D
  std::int64_t cells_per_diameter = 8;
  std::int64_t particles_near_pipe = 2;
  double domain_width = 14.0;       ///< D
  double domain_depth_below = 8.5;  ///< D
  double far_cell_ratio = 1.0;
  Symmetry symmetry = Symmetry::automatic;

  std::size_t detection = contact::detection_named("spring");
  contact::Normal normal = contact::Normal::surface;
  double gap_cells = 0.6;
  std::optional<double> friction;

  Geostatic geostatic = Geostatic::prescribed;
  double K0 = 0.5;
  double gravity = 9.81;  ///< m/s^2
  double damping = 0.7;
  double geostatic_tolerance = 1e-3;
  double geostatic_stress_tolerance = 0.02;
  double geostatic_reaction_tolerance = 0.1;

  PipeOptions();
  void declare(options::OptionSet& options);

  bool is_half() const { return symmetry != Symmetry::full; }
  double radius() const { return 0.5 * diameter; }
  double depth() const { return embedment_ratio * diameter; }  ///< H, m
  double cell() const { return diameter / static_cast<double>(cells_per_diameter); }
  double friction_coefficient() const;
  double density() const;                                     ///< kg/m^3, initial
  double unit_weight() const { return density() * gravity; }  ///< gamma, N/m^3
  /// gamma H D, N/m: what makes a reaction dimensionless.
  double reference_force() const { return unit_weight() * depth() * diameter; }

  /// Downward, at a speed that inertia sets; null where a velocity is given.
  std::shared_ptr<contact::PacedMotion<2>> paced_motion() const;
  /// Downward, at the given velocity once it has risen.
  std::shared_ptr<contact::Motion<2>> ramped_motion() const;
  run::InertiaOptions inertia() const;
  /// Grid, walls, sand and gravity. Throws BadInput if the grid would be too large.
  solver::SimulationSetup<2> setup() const;
  /// Points that fill the pipe, for contact found through its nodal mass.
  std::vector<Vector<2>> points_in_pipe(double spacing) const;

 private:
  basis::KnotLines horizontal_lines() const;
  basis::KnotLines vertical_lines() const;
  particles::Filling<2> filling(bool graded) const;
  void declare_pipe(options::OptionSet& options);
  void declare_grid(options::OptionSet& options);
  void check_domain(options::OptionSet& options);
  void declare_contact(options::OptionSet& options);
  void declare_geostatic(options::OptionSet& options);
};

}  // namespace mpm::cases
