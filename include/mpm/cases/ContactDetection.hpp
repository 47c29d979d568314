#pragma once

#include "mpm/contact/RigidContact.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::cases {

/// Declares -contact_detection and -contact_gap_cells.
inline void declare_detection(options::OptionSet& options, contact::Detection& detection,
                              double& gap_cells) {
  using contact::Detection;
  options.choice("contact_detection", detection,
                 {{"velocity", Detection::velocity},
                  {"gap", Detection::gap},
                  {"particle", Detection::particle}},
                 {"",
                  "bodies touch where they share nodes and approach (velocity, the paper), on "
                  "nodes within -contact_gap_cells of the rigid body (gap), or on those if most "
                  "particles beside the surface there touch it (particle)",
                  "docs/model.md"});
  options.real(
      "contact_gap_cells", gap_cells, {.minimum = 0.0, .maximum = 2.0},
      {"cells", "largest distance of a touching node from the rigid body", "docs/model.md"});
}

}  // namespace mpm::cases
