#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ShapeOptions.hpp"
#include "mpm/contact/RigidContact.hpp"
#include "mpm/material/LawOptions.hpp"
#include "mpm/run/Checks.hpp"
#include "mpm/run/RunOptions.hpp"

namespace mpm::cases::custom {

/// Things that have a name and options -KIND_NAME_*. Stay where they are: options are bound to
/// them.
template <class Thing>
using Named = std::vector<std::unique_ptr<Thing>>;

/// Soil of one law.
struct RegionOptions {
  std::string name;
  ShapeOptions shape;
  material::LawOptions law;
  double K0 = 0.5;
  std::vector<double> stress;  ///< xx, yy, zz, xy, Pa; in place of that at rest

  void declare(options::OptionSet& set);
};

/// A rigid body and its contact with the soil.
struct BodyOptions {
  std::string name;
  ShapeOptions shape;
  std::vector<double> velocity;  ///< m/s
  double ramp = 0.0;             ///< m
  std::string motion;            ///< file
  double friction = 0.0;
  std::size_t friction_law = 0;
  std::size_t detection = contact::detection_named("spring");
  double gap_cells = 0.6;
  std::vector<double> contour;  ///< m, from the body to where the contour begins and ends

  bool moves() const { return !velocity.empty() || !motion.empty(); }
  void declare(options::OptionSet& set);
};

/// A pressure on surfaces that face one way or another.
struct LoadOptions {
  std::string name;
  std::array<std::optional<double>, 6> pressure;  ///< Pa, of the sides 2 d and 2 d + 1
  std::vector<double> box;                        ///< where it acts, m; everywhere if empty

  void declare(options::OptionSet& set);
};

enum class Bodies { moving, held };
enum class Begin { automatic, as_it_is, at_rest, anew };

struct StageOptions {
  std::string name;
  std::string until;
  double damping = 0.0;
  Bodies bodies = Bodies::moving;
  Begin begin = Begin::automatic;
  double rest_tolerance = 1e-3;
  std::optional<double> rest_force;  ///< N

  bool is_settling() const { return until == "rest"; }
  void declare(options::OptionSet& set);
};

/// All options of -scene custom. Stays where it is.
struct CustomOptions {
  run::RunOptions run;
  run::Checks checks;
  std::int64_t dimension = 2;
  std::vector<double> domain;
  std::optional<double> cell_size;
  std::array<std::string, 3> lines_files;
  std::vector<double> fine_box;
  double far_cell_ratio = 1.0;
  std::vector<std::string> walls;
  double gravity = 9.81;
  double gravity_angle = 0.0;  ///< degrees
  std::vector<std::string> region_names, body_names, load_names, stage_names{"run"};
  Named<RegionOptions> regions;
  Named<BodyOptions> bodies;
  Named<LoadOptions> loads;
  Named<StageOptions> stages;
  std::vector<double> watched;  ///< points, m

  CustomOptions();
  void declare(options::OptionSet& set);

 private:
  void declare_space(options::OptionSet& set);
  void declare_things(options::OptionSet& set);
};

}  // namespace mpm::cases::custom
