#pragma once

#include <string>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/options/OptionSet.hpp"
#include "mpm/options/TableChoice.hpp"

namespace mpm::cases {

/// Declares -contact_detection and -contact_gap_cells; `detection` is a row of the table.
inline void declare_detection(options::OptionSet& set, std::size_t& detection, double& gap_cells) {
  std::string sentence = "bodies touch";
  for (const contact::DetectionKind& kind : contact::detection_kinds())
    sentence += std::string(sentence.ends_with("touch") ? " " : ", or ") +
                std::string(kind.sentence) + " (" + std::string(kind.name) + ")";
  set.choice("contact_detection", detection, options::rows_by_name(contact::detection_kinds()),
             {"", sentence, "docs/model.md"});
  const auto is_named = [&detection](const char* name) {
    return detection == contact::detection_named(name);
  };
  set.real("contact_gap_cells", gap_cells, {.minimum = 0.0, .maximum = 2.0},
           {"cells", "largest distance of a touching node from the rigid body", "docs/model.md"});
  set.effective([is_named] { return is_named("gap") || is_named("particle"); },
                "only with -contact_detection gap or particle");
}

}  // namespace mpm::cases
