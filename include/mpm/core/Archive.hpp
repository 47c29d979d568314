#pragma once

#include <array>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace mpm {

/// Values by name that are saved or put back: one `persist(archive)` per class does both, so that
/// nothing can be saved that is not put back. Whole numbers below 2^53 and flags pass as numbers.
class Archive {
 public:
  /// One that takes values.
  Archive() = default;
  /// One that gives back what another has taken.
  explicit Archive(std::map<std::string, std::vector<double>> values)
      : m_values(std::move(values)), m_gives(true) {}

  bool gives() const { return m_gives; }
  const std::map<std::string, std::vector<double>>& values() const { return m_values; }

  /// Takes `value`, or sets it to what was taken. Throws std::logic_error for a name that was taken
  /// twice or never.
  template <class Number>
  void operator()(const std::string& name, Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    std::vector<double> list{static_cast<double>(value)};
    (*this)(name, list);
    value = static_cast<Number>(list.at(0));
  }
  void operator()(const std::string& name, std::vector<double>& values);
  template <std::size_t size>
  void operator()(const std::string& name, std::array<double, size>& values) {
    std::vector<double> list(values.begin(), values.end());
    (*this)(name, list);
    for (std::size_t k = 0; k < size; ++k) values[k] = list.at(k);
  }

  /// Names that `inside` uses begin with `name` and a dot.
  template <class Inside>
  void group(const std::string& name, const Inside& inside) {
    const std::string before = m_prefix;
    m_prefix += name + ".";
    inside();
    m_prefix = before;
  }

 private:
  std::map<std::string, std::vector<double>> m_values;
  std::string m_prefix;
  bool m_gives = false;
};

}  // namespace mpm
