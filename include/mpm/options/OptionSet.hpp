#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mpm::options {

/// What users read about an option; `source` says where the default comes from.
struct About {
  std::string unit;      ///< SI unit, "1" when dimensionless
  std::string sentence;  ///< one sentence
  std::string source;    ///< e.g. "Table 1", "Eq. 12", "chosen: see docs/model.md"
};

/// Allowed interval; `open_*` excludes the end itself.
template <class Number>
struct Range {
  Number minimum = std::numeric_limits<Number>::lowest();
  Number maximum = std::numeric_limits<Number>::max();
  bool open_minimum = false;
  bool open_maximum = false;
};
using RealRange = Range<double>;
using IntegerRange = Range<std::int64_t>;

inline RealRange positive() { return {.minimum = 0.0, .open_minimum = true}; }
inline RealRange not_negative() { return {.minimum = 0.0}; }
inline RealRange between(double minimum, double maximum) { return {minimum, maximum}; }

/// One option as given, with the place it came from for messages ("command line",
/// "input/pipe.opts:12").
struct Given {
  std::string name;  ///< without the leading dash
  std::string value;
  std::string origin;
};

/// The options of a run, each declared once. The value bound at declaration is the default;
/// `assign` overwrites it. Names are given without the leading dash.
class OptionSet {
 public:
  /// Following declarations belong to this heading of help and reference.
  void section(std::string title);

  void real(std::string name, double& value, RealRange allowed, About about);
  void integer(std::string name, std::int64_t& value, IntegerRange allowed, About about);
  void text(std::string name, std::string& value, About about);
  void flag(std::string name, bool& value, About about);  ///< values true|false
  void real_list(std::string name, std::vector<double>& value, RealRange allowed, About about);
  /// No default value: `when_absent` says what holds then ("tan(0.6 phi_c)").
  void optional_real(std::string name, std::optional<double>& value, RealRange allowed,
                     std::string when_absent, About about);
  template <class Enum>
  void choice(std::string name, Enum& value,
              std::vector<std::pair<std::string, Enum>> alternatives, About about);

  /// Parses and checks what was given. Throws BadInput that names the option, the value, what is
  /// allowed, and for an unknown name the nearest declared one.
  void assign(std::span<const Given> given);

  bool is_given(std::string_view name) const;

  /// Aligned plain text for -help.
  std::string help() const;
  /// Markdown tables for the reference page.
  std::string markdown() const;
  /// Every option with its present value as an options file that reproduces the run.
  std::string used() const;
  /// Name and present value of every option (text as in an options file), in declared order.
  std::vector<std::pair<std::string, std::string>> values() const;

 private:
  struct Option {
    std::string section;
    std::string name;
    std::string kind;     ///< "real", "integer", ... for help
    std::string allowed;  ///< readable range or list of words
    std::string initial;  ///< default as text
    About about;
    std::function<void(const Given&)> parse;      ///< throws BadInput
    std::function<std::string()> present;         ///< present value as text, empty if unset
    bool given = false;
  };
  void add(Option option);
  void choice_of_words(std::string name, std::vector<std::string> words,
                       std::function<void(std::size_t)> select,
                       std::function<std::size_t()> selected, About about);

  std::string m_section;
  std::vector<Option> m_options;
};

template <class Enum>
void OptionSet::choice(std::string name, Enum& value,
                       std::vector<std::pair<std::string, Enum>> alternatives, About about) {
  std::vector<std::string> words;
  for (const auto& alternative : alternatives) words.push_back(alternative.first);
  auto select = [&value, alternatives](std::size_t k) { value = alternatives[k].second; };
  auto selected = [&value, alternatives] {
    std::size_t k = 0;
    while (k + 1 < alternatives.size() && alternatives[k].second != value) ++k;
    return k;
  };
  choice_of_words(std::move(name), std::move(words), select, selected, std::move(about));
}

}  // namespace mpm::options
