#pragma once

#include <functional>
#include <vector>

#include "mpm/particles/Particles.hpp"

namespace mpm::transfer {

/// Acceleration by body forces, m/s^2.
template <int dim>
struct BodyForce {
  Vector<dim> uniform{};
  /// Replaces the uniform one where set: a function of the undeformed position, which is the
  /// position less the displacement.
  std::function<Vector<dim>(const Vector<dim>&)> at_reference_position;
};

/// Body force b_p of a rank's particles during one step: found once, read by every sweep.
template <int dim>
class ParticleBodyForce {
 public:
  void find(const BodyForce<dim>& body_force, const particles::ParticleView<dim>& particles) {
    m_uniform = body_force.uniform;
    m_each.clear();
    m_is_uniform = !body_force.at_reference_position;
    if (m_is_uniform) return;
    for (int p = 0; p < particles.count; ++p) {
      Vector<dim> X = particles.position_of(p);
      for (int d = 0; d < dim; ++d) X[d] -= particles.displacement[d][p];
      m_each.push_back(body_force.at_reference_position(X));
    }
  }
  bool is_uniform() const { return m_is_uniform; }
  const Vector<dim>& uniform() const { return m_uniform; }
  const Vector<dim>& operator[](int p) const {
    return m_is_uniform ? m_uniform : m_each[static_cast<std::size_t>(p)];
  }

 private:
  bool m_is_uniform = true;
  Vector<dim> m_uniform{};
  std::vector<Vector<dim>> m_each;  ///< empty where uniform
};

}  // namespace mpm::transfer
