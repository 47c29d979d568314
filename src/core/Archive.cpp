#include "mpm/core/Archive.hpp"

#include <stdexcept>

namespace mpm {

void Archive::operator()(const std::string& name, std::vector<double>& values) {
  const std::string full = m_prefix + name;
  const auto place = m_values.find(full);
  if ((place != m_values.end()) != m_gives)
    throw std::logic_error("'" + full + (m_gives ? "' was never saved" : "' is saved twice"));
  if (m_gives)
    values = place->second;
  else
    m_values.emplace(full, values);
}

}  // namespace mpm
