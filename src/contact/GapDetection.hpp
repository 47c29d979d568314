#pragma once

#include <algorithm>

#include "mpm/contact/Detection.hpp"

namespace mpm::contact {

/// Nodes within a share of a cell of the surface touch it.
template <int dim>
class GapDetection : public Detection<dim> {
 public:
  explicit GapDetection(const DetectionParts<dim>& parts) : m_parts(parts) {
    for (int d = 0; d < dim; ++d)
      m_reach =
          std::max(m_reach, parts.gap_cells * std::ranges::max(parts.grid.nodes(d).cell_width));
  }

  /// Passes over nodes that are too close to a far one to be near.
  void find(const grid::Run<dim>& run, std::vector<NearNode<dim>>& nodes) const override {
    const double* const x = m_parts.grid.nodes(0).positions.data() + run.node[0];
    for (int k = 0; k < run.count;) {
      std::array<int, dim> node = run.node;
      node[0] += k;
      const auto [distance, normal] = m_parts.body.locate(m_parts.grid.position(node));
      if (is_near(node, distance)) nodes.push_back({run.first + k, node, normal});
      const double next = x[k++] + (1.0 - round_off) * (distance - m_reach);
      while (k < run.count && x[k] < next) ++k;
    }
  }

 private:
  static constexpr double round_off = 1e-12;

  bool is_near(const std::array<int, dim>& node, double distance) const {
    double cell = 0.0;
    for (int d = 0; d < dim; ++d)
      cell = std::max(cell, m_parts.grid.nodes(d).cell_width[static_cast<std::size_t>(node[d])]);
    return distance <= m_parts.gap_cells * cell;
  }

  DetectionParts<dim> m_parts;
  double m_reach = 0.0;  ///< largest distance of a near node, m
};

}  // namespace mpm::contact
