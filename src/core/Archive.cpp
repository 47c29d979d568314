#include "mpm/core/Archive.hpp"

#include <stdexcept>

namespace mpm {

void Archive::pass(Kind kind, const std::string& name, std::vector<double>& values) {
  const std::string full = m_prefix + name;
  if (!m_asked.insert(full).second)
    throw std::logic_error("'" + full + (m_gives ? "' is put back twice" : "' is saved twice"));
  if (!m_gives) {
    m_entries.emplace(full, Entry{kind, values});
    return;
  }
  const auto place = m_entries.find(full);
  if (place == m_entries.end()) throw std::logic_error("'" + full + "' was never saved");
  if (place->second.kind != kind) throw std::logic_error("'" + full + "' was saved otherwise");
  if (kind != Kind::own || m_on_same_ranks) values = place->second.values;
}

std::vector<std::string> Archive::left() const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : m_entries)
    if (m_gives && !m_asked.contains(name)) names.push_back(name);
  return names;
}

}  // namespace mpm
