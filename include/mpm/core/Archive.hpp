#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace mpm {

/// Values by name that are saved or put back: one `persist(archive)` per class does both, so that
/// nothing can be saved that is not put back. Whole numbers below 2^53 and flags pass as numbers.
/// How a value is called says what becomes of it where there are more or fewer ranks than before.
class Archive {
 public:
  enum class Kind {
    shared,   ///< the same on all ranks
    sum,      ///< a rank's share of a sum
    largest,  ///< the largest that a rank has seen
    list,     ///< entries that a rank has, looked up by what they say
    own       ///< makes sense only on this rank: left as it is where there are other ranks
  };
  struct Entry {
    Kind kind;
    std::vector<double> values;
    bool operator==(const Entry&) const = default;
  };
  using Entries = std::map<std::string, Entry>;

  /// One that takes values.
  Archive() = default;
  /// One that gives back what another has taken; `on_same_ranks` as it was then.
  explicit Archive(Entries entries, bool on_same_ranks = true)
      : m_entries(std::move(entries)), m_gives(true), m_on_same_ranks(on_same_ranks) {}

  bool gives() const { return m_gives; }
  const Entries& values() const { return m_entries; }
  /// Names that nobody has asked for yet, of an archive that gives.
  std::vector<std::string> left() const;

  /// Takes `value`, or sets it to what was taken. Throws std::logic_error for a name that was taken
  /// twice or never, or as something else.
  template <class Value>
  void operator()(const std::string& name, Value& value) {
    pass(Kind::shared, name, value);
  }
  template <class Value>
  void sum(const std::string& name, Value& value) {
    pass(Kind::sum, name, value);
  }
  template <class Value>
  void largest(const std::string& name, Value& value) {
    pass(Kind::largest, name, value);
  }
  void list(const std::string& name, std::vector<double>& values) {
    pass(Kind::list, name, values);
  }
  template <class Value>
  void own(const std::string& name, Value& value) {
    pass(Kind::own, name, value);
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
  template <class Number>
  void pass(Kind kind, const std::string& name, Number& value) {
    static_assert(std::is_arithmetic_v<Number>);
    std::vector<double> list{static_cast<double>(value)};
    pass(kind, name, list);
    value = static_cast<Number>(list.at(0));
  }
  template <class Number, std::size_t size>
  void pass(Kind kind, const std::string& name, std::array<Number, size>& values) {
    std::vector<double> list(values.begin(), values.end());
    pass(kind, name, list);
    for (std::size_t k = 0; k < size; ++k) values[k] = static_cast<Number>(list.at(k));
  }
  void pass(Kind kind, const std::string& name, std::vector<double>& values);

  Entries m_entries;
  std::set<std::string> m_asked;
  std::string m_prefix;
  bool m_gives = false;
  bool m_on_same_ranks = true;
};

}  // namespace mpm
