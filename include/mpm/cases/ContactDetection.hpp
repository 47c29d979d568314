#pragma once

#include <string>
#include <utility>
#include <vector>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::cases {

/// Words and rows of the table of detections.
inline std::vector<std::pair<std::string, std::size_t>> detections() {
  std::vector<std::pair<std::string, std::size_t>> rows;
  for (const contact::DetectionKind& kind : contact::detection_kinds())
    rows.emplace_back(std::string(kind.name), rows.size());
  return rows;
}

/// Declares -contact_detection and -contact_gap_cells; `detection` is a row of the table.
inline void declare_detection(options::OptionSet& options, std::size_t& detection,
                              double& gap_cells) {
  std::string sentence = "bodies touch";
  for (const contact::DetectionKind& kind : contact::detection_kinds())
    sentence += std::string(sentence.ends_with("touch") ? " " : ", or ") +
                std::string(kind.sentence) + " (" + std::string(kind.name) + ")";
  options.choice("contact_detection", detection, detections(), {"", sentence, "docs/model.md"});
  options.real(
      "contact_gap_cells", gap_cells, {.minimum = 0.0, .maximum = 2.0},
      {"cells", "largest distance of a touching node from the rigid body", "docs/model.md"});
}

}  // namespace mpm::cases
