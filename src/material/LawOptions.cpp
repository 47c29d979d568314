#include "mpm/material/LawOptions.hpp"

#include "mpm/options/OptionSet.hpp"
#include "mpm/options/TableChoice.hpp"

namespace mpm::material {

LawOptions::LawOptions() {
  for (const MaterialKind& kind : material_kinds()) m_factories.push_back(kind.make_factory());
}

void LawOptions::declare(options::OptionSet& set) {
  set.choice("material", m_law, options::rows_by_name(material_kinds()),
             {"",
              "law of the table; its constants follow with the same prefix, named as in -scene "
              "material_point",
              "docs/model.md", true});
  set.opens([this, &set] { m_factories[m_law]->declare(set); }, [] {});
}

}  // namespace mpm::material
