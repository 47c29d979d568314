#include "mpm/io/Summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mpm/io/TextFile.hpp"
#include "mpm/io/Vocabulary.hpp"

namespace mpm::io {
namespace {

nlohmann::ordered_json as_json(const Summary::Value& value) {
  return std::visit([](const auto& held) { return nlohmann::ordered_json(held); }, value);
}

}  // namespace

void Summary::set(const std::string& key, Value value) {
  if (find_answer(key) == nullptr)
    throw std::logic_error(
        fmt::format("the answer '{}' is not declared in src/io/Vocabulary.cpp", key));
  const auto entry = std::ranges::find(m_values, key, [](const auto& pair) { return pair.first; });
  if (entry != m_values.end())
    entry->second = std::move(value);
  else
    m_values.emplace_back(key, std::move(value));
}

const Summary::Value* Summary::find(const std::string& key) const {
  const auto entry = std::ranges::find(m_values, key, [](const auto& pair) { return pair.first; });
  return entry != m_values.end() ? &entry->second : nullptr;
}

std::vector<std::string> Summary::texts(const std::string& key) const {
  const Value* value = find(key);
  return value != nullptr ? std::get<std::vector<std::string>>(*value) : std::vector<std::string>{};
}

void Summary::append(const std::string& key, const std::string& text) {
  std::vector<std::string> all = texts(key);
  all.push_back(text);
  set(key, std::move(all));
}

double Summary::number(const std::string& key) const {
  const Value* value = find(key);
  if (value == nullptr || value->index() >= 4)  // texts and lists
    throw std::out_of_range(fmt::format("the summary has no number '{}'", key));
  return as_json(*value).get<double>();
}

void Summary::add_options(const options::OptionSet& options) {
  for (const auto& [name, value] : options.values()) {
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    const bool is_number = !value.empty() && *end == '\0';
    set("option_" + name, is_number ? Value(number) : Value(value));
  }
}

std::string Summary::text(const std::string& key) const {
  const Value* value = find(key);
  if (value == nullptr) return "";
  const auto* text = std::get_if<std::string>(value);
  return text != nullptr ? *text : as_json(*value).dump();
}

std::string Summary::json() const {
  auto object = nlohmann::ordered_json::object();
  for (const auto& [key, value] : m_values) object[key] = as_json(value);
  return object.dump(2) + "\n";
}

void Summary::write(const std::string& directory, const petsc::Communicator& communicator) const {
  write_text_file(directory + "/summary.json", json(), communicator);
}

}  // namespace mpm::io
