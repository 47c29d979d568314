#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mpm/material/Material.hpp"

namespace mpm::material {

/// A law of the table, named by an option, with its constants in options of the same prefix. Stays
/// where it is: the set is bound to it.
class LawOptions {
 public:
  LawOptions();
  LawOptions(const LawOptions&) = delete;
  LawOptions& operator=(const LawOptions&) = delete;

  /// Declares -material and what the law that it names declares, in this section.
  void declare(options::OptionSet& set);
  std::unique_ptr<Material> create() const { return m_factories[m_law]->create(); }

 private:
  std::vector<std::unique_ptr<MaterialFactory>> m_factories;  ///< of the rows of the table
  std::size_t m_law = 0;
};

}  // namespace mpm::material
