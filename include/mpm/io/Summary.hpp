#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mpm/options/OptionSet.hpp"
#include "mpm/petsc/Session.hpp"

namespace mpm::io {

/// The flat summary of a run: every answer a key of the vocabulary (see
/// Vocabulary.hpp), in the order in which they were first set.
class Summary {
 public:
  using Value = std::variant<double, std::int64_t, std::uint64_t, bool, std::string,
                             std::vector<double>, std::vector<std::string>>;

  /// Throws std::logic_error for a key that the vocabulary does not have.
  void set(const std::string& key, Value value);
  bool has(const std::string& key) const { return find(key) != nullptr; }
  /// Throws std::out_of_range if there is no number of that name.
  double number(const std::string& key) const;

  /// Adds every option as "option_NAME", numbers as numbers.
  void add_options(const options::OptionSet& options);

  /// Says beside the answer what makes it doubtful; `warnings` has all of them.
  void warn(const std::string& sentence) { append("warnings", sentence); }
  /// Says why the run has no answer; `answer_withheld` has all reasons. Whoever sets the answer
  /// leaves it out.
  void withhold(const std::string& reason) { append("answer_withheld", reason); }
  bool is_withheld() const { return !texts("answer_withheld").empty(); }
  /// A list of texts; empty where there is none.
  std::vector<std::string> texts(const std::string& key) const;

  /// Readable text of one entry; "" if there is none.
  std::string text(const std::string& key) const;
  /// All entries as a JSON object; a number that is none becomes null.
  std::string json() const;
  /// Writes DIRECTORY/summary.json. Collective.
  void write(const std::string& directory,
             const petsc::Communicator& communicator = petsc::world()) const;

 private:
  void append(const std::string& key, const std::string& text);
  const Value* find(const std::string& key) const;

  std::vector<std::pair<std::string, Value>> m_values;
};

}  // namespace mpm::io
