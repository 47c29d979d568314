#pragma once

#include <string>
#include <vector>

#include "mpm/contact/Motion.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/run/Checks.hpp"
#include "mpm/run/RunOptions.hpp"
#include "mpm/solver/Simulation.hpp"

namespace mpm::cases {

/// Options of the biaxial scene. The specimen stands on y = 0, its axis is x = 0.
struct BiaxialOptions {
  run::RunOptions run;
  material::SandFactory sand;
  run::Checks checks;

  double width = 1.0;   ///< m
  double height = 2.0;  ///< m
  double cell_size = 0.1;
  double confining_pressure = 400e3;
  double velocity = 0.03;      ///< m/s
  double ramp_strain = 0.001;  ///< axial strain in which the plate gets to its velocity
  double strain_end = 0.15;
  double friction = 100.0;
  double gap_cells = 0.6;
  double damping = 0.7;
  double tolerance = 1e-3;
  std::vector<double> points{0.0, 1.5, 0.0, 1.2};  ///< x and y of two particles to be watched, m

  BiaxialOptions();
  void declare(options::OptionSet& options);
  solver::SimulationSetup<2> setup() const;
  std::vector<particles::SurfacePiece<2>> sides() const;
  contact::Ramp ramp() const { return {velocity, ramp_strain * height}; }

 private:
  void declare_specimen(options::OptionSet& options);
  void declare_loading(options::OptionSet& options);
  int cells_over(const char* name, double length) const;
};

}  // namespace mpm::cases
