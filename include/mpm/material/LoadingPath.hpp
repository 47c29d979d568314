#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "mpm/material/ElementTest.hpp"

namespace mpm::material {

/// Reads a loading path that somebody wrote by hand: a CSV file whose header names, in any order,
/// `increments` and what is controlled, and whose lines are legs followed one after the other.
///
///   strain_xx strain_yy strain_zz              logarithmic normal strains, compression positive
///   stress_xx_Pa stress_yy_Pa stress_zz_Pa     normal stresses, compression positive
///   gamma_xy gamma_yz gamma_xz                 engineering shear strains, du_x/dy + du_y/dx
///   stress_xy_Pa stress_yz_Pa stress_xz_Pa     shear stresses that do positive work on gamma
///
/// A field is the value to be reached at the end of the leg, counted from the unstressed origin
/// (stress) or the start of the test (strain); `hold` stays at the value that the leg begins with;
/// empty leaves the component to the other control. On the way values grow in proportion. Each leg
/// controls every normal component once; a shear strain that nothing controls is held. # begins a
/// comment. Throws BadInput that names -path_file, the line and what is allowed.
std::vector<PathLeg> read_path_file(const std::string& path);

/// The same from text; `name` stands for the file in messages.
std::vector<PathLeg> read_path(const std::string& text, const std::string& name);

}  // namespace mpm::material
