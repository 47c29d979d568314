#include "mpm/io/Summary.hpp"

#include <cstdlib>
#include <stdexcept>

#include "mpm/io/TextFile.hpp"
#include "mpm/io/Vocabulary.hpp"

namespace mpm::io {

void Summary::add_options(const options::OptionSet& options) {
  for (const auto& [name, value] : options.values()) {
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    const bool is_number = !value.empty() && *end == '\0';
    if (is_number)
      m_values["option_" + name] = number;
    else
      m_values["option_" + name] = value;
  }
}

const std::string& Summary::declared(const std::string& key) {
  if (find_answer(key) == nullptr)
    throw std::logic_error("the answer '" + key + "' is not declared in src/io/Vocabulary.cpp");
  return key;
}

std::string Summary::text(const std::string& key) const {
  if (!has(key)) return "";
  const auto& value = m_values.at(key);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void Summary::write(const std::string& directory) const {
  write_text_file(directory + "/summary.json", m_values.dump(2) + "\n");
}

}  // namespace mpm::io
