#include <fmt/format.h>

#include "mpm/options/OptionSet.hpp"

namespace mpm::options {

void OptionSet::caution(std::function<std::string()> look) {
  m_cautions.push_back(std::move(look));
}

void OptionSet::effective(std::function<bool()> holds, std::string only) {
  caution([this, name = m_options.back().name, holds = std::move(holds), only = std::move(only)] {
    if (!is_changed(name) || holds()) return std::string();
    return fmt::format("-{} {} has no effect: {}", name, given(name).value, only);
  });
}

std::vector<std::string> OptionSet::cautions() const {
  std::vector<std::string> all;
  for (const auto& look : m_cautions)
    if (std::string sentence = look(); !sentence.empty()) all.push_back(std::move(sentence));
  return all;
}

}  // namespace mpm::options
