#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mpm/core/Tensor.hpp"
#include "mpm/geometry/Shape.hpp"

namespace mpm::cases {

/// A part of the ground with a law of its own.
template <int dim>
struct Region {
  std::string name;
  std::shared_ptr<const geometry::Shape<dim>> shape;
  double unit_weight = 0.0;  ///< gamma, N/m^3
  double K0 = 1.0;           ///< horizontal over vertical stress at rest
  /// In place of the stress at rest; tension positive, Pa.
  std::optional<SymmetricTensor> stress = std::nullopt;
};

/// Regions of soil below a surface of any form; later ones replace earlier ones where they overlap.
template <int dim>
class Ground {
 public:
  /// Pressure on the surface at a point of it, Pa.
  using Surcharge = std::function<double(const Vector<dim>&)>;

  /// Gravity acts against the unit vector `up`, the vertical of this ground.
  Ground(std::vector<Region<dim>> regions, Surcharge surcharge,
         const Vector<dim>& up = geometry::upward<dim>())
      : m_regions(std::move(regions)), m_surcharge(std::move(surcharge)), m_up(up) {}

  std::optional<int> region_at(const Vector<dim>& x) const;

  /// At rest: the vertical stress is the surcharge and the weight of all regions above x, as if
  /// soil and not a rigid body were there; the horizontal ones are K0 times that in both
  /// directions. Exact below a level surface of level layers. Tension positive, Pa.
  SymmetricTensor stress_at(const Vector<dim>& x) const;

 private:
  double load_above(const Vector<dim>& x) const;
  std::vector<double> heights_above(const Vector<dim>& x) const;
  Vector<dim> raised(Vector<dim> x, double by) const;

  std::vector<Region<dim>> m_regions;
  Surcharge m_surcharge;
  Vector<dim> m_up;
};

extern template class Ground<1>;
extern template class Ground<2>;
extern template class Ground<3>;

}  // namespace mpm::cases
