#pragma once

#include <string>

#include "mpm/contact/Detection.hpp"
#include "mpm/contact/Friction.hpp"

namespace mpm::contact {

/// Where the contact normal of nodes comes from.
enum class Normal {
  surface,  ///< the rigid surface itself
  gradient  ///< the gradient of the rigid body's nodal mass (the paper)
};

struct ContactOptions {
  std::size_t detection = detection_named("gap");  ///< row of detection_kinds()
  Normal normal = Normal::surface;
  double gap_cells = 0.6;          ///< largest distance of a touching node, in cells
  double friction = 0.0;           ///< Coulomb coefficient mu
  std::size_t friction_law = 0;    ///< row of friction_kinds()
  double reference_density = 1.0;  ///< of the deformable body, kg/m^3: nodes with less than 1e-9
                                   ///< of a full cell's mass take no part
  std::string label = "contact";   ///< in the ledger, and of the particle fields of a contact
};

}  // namespace mpm::contact
