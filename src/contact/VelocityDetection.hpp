#pragma once

#include "ScalarAndGradient.hpp"
#include "mpm/contact/Detection.hpp"

namespace mpm::contact {

/// Nodes that body and soil share touch as soon as they approach (the paper).
template <int dim>
class VelocityDetection : public Detection<dim> {
 public:
  explicit VelocityDetection(const DetectionParts<dim>& parts) : m_parts(parts) {}

  void prepare() override { m_parts.rigid_mass.provide(); }

  void find(const grid::Run<dim>& run, std::vector<NearNode<dim>>& nodes) const override {
    for (int k = 0; k < run.count; ++k) {
      const double volume = m_parts.rigid_mass.volume(run.first + k);
      if (volume == 0.0) continue;
      std::array<int, dim> node = run.node;
      node[0] += k;
      if (volume >= smallest_mass_share * cell_volume<dim>(m_parts.grid, node))
        nodes.push_back(
            {run.first + k, node, m_parts.body.locate(m_parts.grid.position(node)).normal});
    }
  }

 private:
  DetectionParts<dim> m_parts;
};

}  // namespace mpm::contact
