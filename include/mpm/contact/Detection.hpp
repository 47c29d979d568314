#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "mpm/contact/RigidMass.hpp"
#include "mpm/particles/Particles.hpp"

namespace mpm::contact {

/// A node where a rigid body and the soil touch if they close in on each other.
template <int dim>
struct NearNode {
  int local;
  std::array<int, dim> node;
  Vector<dim> surface_normal;  ///< out of the rigid body, unit
};

/// Says which nodes touch a rigid body; what happens there, friction says.
template <int dim>
class Detection {
 public:
  virtual ~Detection() = default;
  /// Before every step, while particles and nodes are as the step before left them. Local.
  virtual void look_at_particles() {}
  /// Makes ready to find the nodes of a step. Collective.
  virtual void prepare() {}
  /// Appends the touching nodes of a run. Local.
  virtual void find(const grid::Run<dim>& run, std::vector<NearNode<dim>>& nodes) const = 0;
};

/// What detections are made from; all of it outlives them.
template <int dim>
struct DetectionParts {
  const grid::Grid<dim>& grid;
  const grid::Walls<dim>& walls;
  const transfer::PointDeposit<dim>& deposit;
  const RigidBody<dim>& body;
  RigidMass<dim>& rigid_mass;
  double gap_cells;  ///< largest distance of a touching node
  /// Of the deformable body; may be told later than the rest.
  const particles::Particles<dim>* const& particles;
};

/// How contact is found: on nodes by a Detection, or by springs at particles.
struct DetectionKind {
  std::string_view name;
  std::string_view sentence;  ///< "bodies touch ..."
  std::unique_ptr<Detection<1>> (*make_1d)(const DetectionParts<1>&);
  std::unique_ptr<Detection<2>> (*make_2d)(const DetectionParts<2>&);
  std::unique_ptr<Detection<3>> (*make_3d)(const DetectionParts<3>&);

  /// Nodes have no part in it, and there is no Detection to make: see SpringContact.
  bool is_by_springs() const { return make_1d == nullptr; }
};

/// The one table of detections: a new one is one file and one line here.
std::span<const DetectionKind> detection_kinds();

/// The row of a name of the table. Throws std::out_of_range for another.
std::size_t detection_named(std::string_view name);

/// The detection of row k of the table.
template <int dim>
std::unique_ptr<Detection<dim>> make_detection(std::size_t k, const DetectionParts<dim>& parts) {
  const DetectionKind& kind = detection_kinds()[k];
  if constexpr (dim == 1) return kind.make_1d(parts);
  if constexpr (dim == 2) return kind.make_2d(parts);
  if constexpr (dim == 3) return kind.make_3d(parts);
}

}  // namespace mpm::contact
