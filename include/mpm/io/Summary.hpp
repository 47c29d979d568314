#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "mpm/options/OptionSet.hpp"

namespace mpm::io {

/// The flat summary of a run: every answer a top-level key of the vocabulary, see Vocabulary.hpp.
class Summary {
 public:
  template <class Value>
  void set(const std::string& key, const Value& value) {
    m_values[declared(key)] = value;
  }
  bool has(const std::string& key) const { return m_values.contains(key); }
  double number(const std::string& key) const { return m_values.at(key).get<double>(); }

  /// Adds every option as "option_NAME", numbers as numbers.
  void add_options(const options::OptionSet& options);

  /// Readable text of one entry; "" if there is none.
  std::string text(const std::string& key) const;
  /// Writes DIRECTORY/summary.json. Collective.
  void write(const std::string& directory) const;

 private:
  /// The key itself. Throws std::logic_error where the vocabulary does not have it.
  static const std::string& declared(const std::string& key);

  nlohmann::ordered_json m_values;
};

}  // namespace mpm::io
