#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "GapDetection.hpp"
#include "ScalarAndGradient.hpp"

namespace mpm::contact {

/// Near nodes touch where most particles beside the surface touch it. Each particle votes with its
/// weight on the nodes that it reaches.
template <int dim>
class ParticleDetection : public Detection<dim> {
 public:
  explicit ParticleDetection(const DetectionParts<dim>& parts)
      : m_parts(parts), m_near(parts), m_votes(parts.grid, scalar_and_gradient<dim>()) {}

  /// Particles whose own extent meets the surface touch it; those that miss it by up to half their
  /// extent lie beside it all the same.
  void look_at_particles() override {
    if (!m_parts.particles) throw std::logic_error("contact by particles without watch()");
    m_touching.clear();
    m_missing.clear();
    const auto view = m_parts.particles->view();
    for (int p = 0; p < view.count; ++p) {
      const Vector<dim> x = view.position_of(p);
      const double extents = m_parts.body.locate(x).distance / std::pow(view.volume[p], 1.0 / dim);
      if (extents <= 1.0) (extents <= 0.5 ? m_touching : m_missing).push_back(x);
    }
  }

  void prepare() override {
    m_votes.set_active_to_zero();
    m_parts.deposit.deposit(m_touching, 1.0, m_parts.grid.reachable_cells(), m_votes);
    m_parts.deposit.deposit(m_missing, -1.0, m_parts.grid.reachable_cells(), m_votes);
    m_votes.sum_to_owners();
    m_parts.walls.fold(m_parts.grid, m_votes);
  }

  void find(const grid::Run<dim>& run, std::vector<NearNode<dim>>& nodes) const override {
    const auto found_before = static_cast<std::ptrdiff_t>(nodes.size());
    m_near.find(run, nodes);
    const auto is_voted_down = [this](const NearNode<dim>& node) {
      return !(m_votes.values(0)[node.local] > round_off);
    };
    nodes.erase(std::remove_if(nodes.begin() + found_before, nodes.end(), is_voted_down),
                nodes.end());
  }

 private:
  static constexpr double round_off = 1e-12;  // of a particle's vote

  DetectionParts<dim> m_parts;
  GapDetection<dim> m_near;
  grid::NodalField<dim> m_votes;                   ///< positive where most particles touch
  std::vector<Vector<dim>> m_touching, m_missing;  ///< particles beside the surface
};

}  // namespace mpm::contact
