#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mpm/options/Given.hpp"
#include "mpm/options/Range.hpp"

namespace mpm::options {

/// What users read about an option; `source` says where the default comes from.
struct About {
  std::string unit;       ///< SI unit, "1" when dimensionless
  std::string sentence;   ///< one sentence
  std::string source;     ///< e.g. "Table 1", "Eq. 12", "chosen: see docs/model.md"
  bool required = false;  ///< no default: `assign` refuses a run without it

  bool is_dimensionless() const { return unit.empty() || unit == "1"; }
};

enum class Kind { real, integer, text, path, input_file, flag, choice, real_list, words, names };

/// The word that tables have for a kind.
std::string_view word_for(Kind kind);

/// One option as pages print it.
struct Row {
  std::string section, name;
  Kind kind = Kind::text;
  std::optional<RealRange> range = {};  ///< of numbers
  std::vector<std::string> words = {};  ///< of a choice
  std::string initial;                  ///< the default for readers
  std::string unit;                     ///< "-" when dimensionless
  std::string allowed, sentence, source;
};

/// The options of a run, each declared once. The value bound at declaration is the default;
/// `assign` overwrites it. Names are given without the leading dash. Empty text and empty lists
/// mean "not set". Bound variables must outlive the set.
///
/// Programming errors throw std::logic_error: a name declared twice or belonging to PETSc, a
/// default that is not allowed, a question about an undeclared name.
class OptionSet {
 public:
  /// `title` is what the options are of.
  explicit OptionSet(std::string title = "") : m_title(std::move(title)) {}
  const std::string& title() const { return m_title; }

  /// Following declarations belong to this heading of help and reference.
  void section(std::string title);

  void real(std::string name, double& value, RealRange allowed, About about);
  void integer(std::string name, std::int64_t& value, IntegerRange allowed, About about);
  void text(std::string name, std::string& value, About about);
  /// Text that names a file or a directory: what only a shell replaces is refused.
  void path(std::string name, std::string& value, About about);
  /// Path of a file that the run reads, listed by input_files().
  void input_file(std::string name, std::string& value, About about);
  /// Values true|false; the bare name means true.
  void flag(std::string name, bool& value, About about);
  void real_list(std::string name, std::vector<double>& value, RealRange allowed, About about);
  /// No default value: `when_absent` says what holds then ("tan(0.6 phi_c)"). The word auto stands
  /// for it.
  void optional_real(std::string name, std::optional<double>& value, RealRange allowed,
                     std::string when_absent, About about);
  template <class Enum>
  void choice(std::string name, Enum& value, std::vector<std::pair<std::string, Enum>> alternatives,
              About about);

  /// Words separated by commas.
  void text_list(std::string name, std::vector<std::string>& value, About about);
  /// Words that name things, each once: letters and digits, a letter first.
  void names(std::string name, std::vector<std::string>& value, About about);

  /// The option declared last says how the program is called, not what a run is: used() has it as a
  /// comment.
  void leave_out_of_used() { m_options.back().is_left_out = true; }

  /// The option declared last says which further options there are: `declare` declares them once
  /// its value is known, before any other option is read; `example` declares what pages show of
  /// them.
  void opens(std::function<void()> declare, std::function<void()> example);
  /// Declares the examples, for pages; the set is good for nothing else afterwards.
  void open_examples();
  /// The names that `declare` declares begin with this.
  void prefixed(const std::string& prefix, const std::function<void()>& declare);
  /// What the names of the next declarations begin with.
  const std::string& prefix() const { return m_prefix; }

  /// A choice that stands for values of other options: `apply(k)` sets them to those of word k. It
  /// comes before all options that are given singly, in whatever order, so that these override it.
  /// Declare it before them: word 0 is applied at once, and what it sets is their default.
  void preset(std::string name, std::vector<std::string> words,
              std::function<void(std::size_t)> apply, About about);
  /// Looks at the options together after `assign` has set them; throws BadInput.
  void rule(std::function<void()> check);
  /// Says what may run but is doubtful together, in one sentence, or nothing: see cautions().
  void caution(std::function<std::string()> look);
  /// The option declared last has an effect only where that holds; `only` says where ("only with
  /// -transfer flip"). A caution where it is changed without.
  void effective(std::function<bool()> holds, std::string only);

  /// Parses and checks what was given. Throws BadInput that names the option, the value, what is
  /// allowed, and for an unknown name the nearest declared one.
  void assign(std::span<const Given> given);

  bool has(std::string_view name) const { return find(name) != nullptr; }
  bool is_given(std::string_view name) const;
  /// Given, and not as its default: used.opts gives every option, and has to pass as it is.
  bool is_changed(std::string_view name) const;
  /// Present value and where it came from ("default" when not given), to refuse it with
  /// `bad_input`.
  Given given(std::string_view name) const;

<<<<<<< HEAD
  /// What is doubtful about the values that `assign` has set.
  std::vector<std::string> cautions() const;
=======
  /// The options that name a file to be read and have been given.
  std::vector<Given> input_files() const;
>>>>>>> input

  /// Aligned plain text for -help.
  std::string help() const;
  /// Every option in declared order, for pages that compare several sets.
  std::vector<Row> rows() const;
  /// Every option with its present value as an options file that reproduces the run.
  std::string used() const;
  /// Name and present value of every option (empty when not set), in declared order.
  std::vector<std::pair<std::string, std::string>> values() const;

 private:
  struct Option {
    std::string name;
    Kind kind = Kind::text;
    std::string allowed;  ///< kind and readable range, or list of words
    About about;
    std::function<std::string(std::string_view)> read;  ///< returns what is wrong, else empty
    std::function<std::string()> present;               ///< present value, empty if not set
    std::optional<RealRange> range = {};
    std::vector<std::string> words = {};
    std::string when_absent = "not set";  ///< what holds without a value
    std::string when_bare = {};           ///< the value a name without one stands for
    std::string section = {};
    std::string initial = {};  ///< the default for readers
    std::string origin = {};   ///< empty unless given
    bool is_preset = false;
    bool is_left_out = false;                            ///< of used()
    std::function<void()> open = {}, open_example = {};  ///< declare further options
  };
  void add(Option option);
  template <class Number>
  void number(std::string name, Number& value, Range<Number> allowed, About about);
  void choice_of_words(std::string name, std::vector<std::string> words,
                       const std::function<void(std::size_t)>& select,
                       const std::function<std::size_t()>& selected, About about);
  const Option* find(std::string_view name) const;
  const Option& declared(std::string_view name) const;
  Option& known(const Given& given);
  static void set(Option& option, const Given& given);
  void assign_openers(std::span<const Given> given);
  void assign_presets(std::span<const Given> given);
  void check_required() const;
  static std::string initial_of(const Option& option);

  static Refusal refuse(const Option& option, const Given& given, std::string fault);
  static std::string help_entry(const Option& option, std::size_t head_width,
                                std::size_t unit_width);
  static std::string used_line(const Option& option);
  std::string by_section(const std::function<std::string(const std::string&)>& heading,
                         const std::function<std::string(const Option&)>& entry) const;

  std::string m_title;
  std::string m_section = "General";
  std::string m_prefix;
  std::vector<Option> m_options;
  std::vector<std::function<void()>> m_rules;
  std::vector<std::function<std::string()>> m_cautions;
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
