#include "mpm/options/OptionSet.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "mpm/options/Characters.hpp"
#include "mpm/options/CommandLine.hpp"
#include "mpm/options/Nearest.hpp"
#include "mpm/options/PetscOptions.hpp"

namespace mpm::options {
namespace {

constexpr std::string_view word_for_absent = "auto";

template <class Number>
std::string allowed_text(std::string_view kind, const Range<Number>& range) {
  const std::string limits = describe(range);
  return limits.empty() ? std::string(kind) : fmt::format("{}, {}", kind, limits);
}

bool breaks_options_files(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return c == '"' || byte < 0x20 || byte == 0x7f;
}

std::string read_text(std::string_view text, std::string& value) {
  if (std::ranges::any_of(text, breaks_options_files))
    return "has a double quote or a control character in it";
  if (!is_utf8(text)) return "is no text (UTF-8)";
  value = text;
  return {};
}

/// Splits at commas; returns what is wrong with an entry, empty if nothing.
std::string read_words(std::string_view text, std::vector<std::string>& words) {
  std::vector<std::string> all;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    if (comma == start) return "has an empty entry";
    const std::string fault = read_text(text.substr(start, comma - start), all.emplace_back());
    if (!fault.empty()) return fault;
    start = comma + 1;
  }
  words = std::move(all);
  return {};
}

bool is_name(std::string_view word) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return is_letter(word.front()) &&
         std::ranges::all_of(word, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

std::string read_names(std::string_view text, std::vector<std::string>& names) {
  std::vector<std::string> all;
  const std::string fault = read_words(text, all);
  if (!fault.empty()) return fault;
  for (const std::string& name : all) {
    if (!is_name(name)) return fmt::format("has an entry '{}' that is no name", name);
    if (std::ranges::count(all, name) > 1) return fmt::format("has '{}' twice", name);
  }
  names = std::move(all);
  return {};
}

std::string read_path(std::string_view text, std::string& value) {
  const std::string fault = fault_of_path(text);
  return fault.empty() ? read_text(text, value) : fault;
}

/// What is wrong with a word, and with the characters in it.
std::string wrong_word(std::string_view word, std::string fault) {
  const std::string foreign = fault_of_characters(word);
  return foreign.empty() ? fault : foreign;
}

RealRange as_reals(const RealRange& range) {
  return range;
}
RealRange as_reals(const IntegerRange& range) {
  return {static_cast<double>(range.minimum), static_cast<double>(range.maximum),
          range.open_minimum, range.open_maximum};
}

std::string read_flag(std::string_view text, bool& value) {
  if (text != "true" && text != "false") return wrong_word(text, "is neither true nor false");
  value = text == "true";
  return {};
}

}  // namespace

void OptionSet::section(std::string title) {
  m_section = std::move(title);
}

template <class Number>
void OptionSet::number(std::string name, Number& value, Range<Number> allowed, About about) {
  constexpr bool real = std::is_same_v<Number, double>;
  add({.name = std::move(name),
       .kind = real ? Kind::real : Kind::integer,
       .allowed = allowed_text(real ? "real" : "integer", allowed),
       .about = std::move(about),
       .read = [allowed, &value](auto text) { return options::read(text, allowed, value); },
       .present = [&value] { return fmt::format("{}", value); },
       .range = as_reals(allowed)});
}

void OptionSet::real(std::string name, double& value, RealRange allowed, About about) {
  number(std::move(name), value, allowed, std::move(about));
}

void OptionSet::integer(std::string name, std::int64_t& value, IntegerRange allowed, About about) {
  number(std::move(name), value, allowed, std::move(about));
}

void OptionSet::text(std::string name, std::string& value, About about) {
  add({.name = std::move(name),
       .allowed = "text",
       .about = std::move(about),
       .read = [&value](auto text) { return read_text(text, value); },
       .present = [&value] { return value; }});
}

void OptionSet::path(std::string name, std::string& value, About about) {
  add({.name = std::move(name),
       .kind = Kind::path,
       .allowed = "path",
       .about = std::move(about),
       .read = [&value](auto text) { return read_path(text, value); },
       .present = [&value] { return value; }});
}

void OptionSet::input_file(std::string name, std::string& value, About about) {
  path(std::move(name), value, std::move(about));
  m_options.back().kind = Kind::input_file;
}

std::vector<Given> OptionSet::input_files() const {
  std::vector<Given> files;
  for (const Option& option : m_options)
    if (option.kind == Kind::input_file && !option.present().empty())
      files.push_back(given(option.name));
  return files;
}

void OptionSet::flag(std::string name, bool& value, About about) {
  add({.name = std::move(name),
       .kind = Kind::flag,
       .allowed = "true | false",
       .about = std::move(about),
       .read = [&value](auto text) { return read_flag(text, value); },
       .present = [&value] { return fmt::format("{}", value); },
       .when_bare = "true"});
}

void OptionSet::real_list(std::string name, std::vector<double>& value, RealRange allowed,
                          About about) {
  add({.name = std::move(name),
       .kind = Kind::real_list,
       .allowed = allowed_text("reals separated by commas", allowed),
       .about = std::move(about),
       .read = [allowed, &value](auto text) { return options::read(text, allowed, value); },
       .present = [&value] { return fmt::format("{}", fmt::join(value, ",")); },
       .range = allowed});
}

void OptionSet::text_list(std::string name, std::vector<std::string>& value, About about) {
  add({.name = std::move(name),
       .kind = Kind::words,
       .allowed = "words separated by commas",
       .about = std::move(about),
       .read = [&value](auto text) { return read_words(text, value); },
       .present = [&value] { return fmt::format("{}", fmt::join(value, ",")); }});
}

void OptionSet::names(std::string name, std::vector<std::string>& value, About about) {
  add({.name = std::move(name),
       .kind = Kind::names,
       .allowed = "names of letters and digits separated by commas, each once",
       .about = std::move(about),
       .read = [&value](auto text) { return read_names(text, value); },
       .present = [&value] { return fmt::format("{}", fmt::join(value, ",")); }});
}

void OptionSet::opens(std::function<void()> declare, std::function<void()> example) {
  const auto as_now = [this, prefix = m_prefix](std::function<void()> inside) {
    return [this, prefix, inside = std::move(inside)] { prefixed(prefix, inside); };
  };
  m_options.back().open = as_now(std::move(declare));
  m_options.back().open_example = as_now(std::move(example));
}

void OptionSet::open_examples() {
  for (std::size_t k = 0; k < m_options.size(); ++k)  // what is opened may open more
    if (const auto open = m_options[k].open_example) open();
}

void OptionSet::prefixed(const std::string& prefix, const std::function<void()>& declare) {
  const std::string before = m_prefix;
  m_prefix += prefix;
  declare();
  m_prefix = before;
}

void OptionSet::optional_real(std::string name, std::optional<double>& value, RealRange allowed,
                              std::string when_absent, About about) {
  const auto read = [allowed, &value](std::string_view text) {
    double number = 0.0;
    if (text == word_for_absent) {
      value.reset();
      return std::string{};
    }
    std::string fault = options::read(text, allowed, number);
    if (fault.empty()) value = number;
    return fault;
  };
  add({.name = std::move(name),
       .kind = Kind::real,
       .allowed = fmt::format("{} | {}", allowed_text("real", allowed), word_for_absent),
       .about = std::move(about),
       .read = read,
       .present = [&value] { return value ? fmt::format("{}", *value) : std::string{}; },
       .range = allowed,
       .when_absent = std::move(when_absent)});
}

void OptionSet::choice_of_words(std::string name, std::vector<std::string> words,
                                const std::function<void(std::size_t)>& select,
                                const std::function<std::size_t()>& selected, About about) {
  const auto read = [words, select](std::string_view text) -> std::string {
    const auto word = std::ranges::find(words, text);
    if (word == words.end())
      return wrong_word(
          text, fmt::format("is not one of the choices, the nearest is {}", nearest(text, words)));
    select(static_cast<std::size_t>(word - words.begin()));
    return {};
  };
  add({.name = std::move(name),
       .kind = Kind::choice,
       .allowed = fmt::format("{}", fmt::join(words, " | ")),
       .about = std::move(about),
       .read = read,
       .present = [words, selected] { return words.at(selected()); },
       .words = words});
}

void OptionSet::preset(std::string name, std::vector<std::string> words,
                       std::function<void(std::size_t)> apply, About about) {
  apply(0);
  const auto selected = std::make_shared<std::size_t>(0);
  const auto select = [selected, apply = std::move(apply)](std::size_t k) {
    *selected = k;
    apply(k);
  };
  choice_of_words(
      std::move(name), std::move(words), select, [selected] { return *selected; },
      std::move(about));
  m_options.back().is_preset = true;
}

void OptionSet::rule(std::function<void()> check) {
  m_rules.push_back(std::move(check));
}

std::string OptionSet::initial_of(const Option& option) {
  if (option.about.required) return "required";
  const std::string value = option.present();
  return value.empty() ? option.when_absent : value;
}

void OptionSet::add(Option option) {
  option.name = m_prefix + option.name;
  const auto refuse_declaration = [&option](std::string_view why) {
    throw std::logic_error(fmt::format("option -{}: {}", option.name, why));
  };
  if (find(option.name) != nullptr) refuse_declaration("declared twice");
  if (is_reserved(option.name)) refuse_declaration("the name is taken by PETSc or the program");

  const std::string value = option.present();
  if (!value.empty()) {
    const std::string fault = option.read(value);
    if (!fault.empty()) refuse_declaration(fmt::format("the default {} {}", value, fault));
  }
  option.section = m_section;
  option.initial = initial_of(option);
  m_options.push_back(std::move(option));
}

void OptionSet::assign(std::span<const Given> given) {
  assign_openers(given);
  assign_presets(given);
  for (const Given& one : given)
    if (Option& option = known(one); !option.is_preset) set(option, one);
  check_required();
  for (const auto& check : m_rules) check();
}

void OptionSet::assign_openers(std::span<const Given> given) {
  for (std::size_t k = 0; k < m_options.size(); ++k) {  // what is opened may open more
    const auto open = m_options[k].open;
    if (!open) continue;
    for (const Given& one : given)
      if (one.name == m_options[k].name) set(m_options[k], one);
    open();
  }
}

/// The last word given of each; what it sets becomes the default of the other options.
void OptionSet::assign_presets(std::span<const Given> given) {
  for (Option& option : m_options) {
    if (!option.is_preset) continue;
    const auto last = std::find_if(given.rbegin(), given.rend(),
                                   [&](const Given& one) { return one.name == option.name; });
    if (last == given.rend()) continue;
    set(option, *last);
    for (Option& other : m_options)
      if (!other.is_preset) other.initial = initial_of(other);
  }
}

void OptionSet::set(Option& option, const Given& given) {
  const std::string& value = given.value.empty() ? option.when_bare : given.value;
  const std::string fault = value.empty() ? "needs a value" : option.read(value);
  if (!fault.empty()) throw bad_input(refuse(option, given, fault));
  option.origin = given.origin;
}

void OptionSet::check_required() const {
  for (const Option& option : m_options)
    if (option.about.required && option.origin.empty())
      throw bad_input(refuse(option, {option.name, "", "not given"}, "is required"));
}

Refusal OptionSet::refuse(const Option& option, const Given& given, std::string fault) {
  const std::string unit = option.about.is_dimensionless() ? "" : ", in " + option.about.unit;
  const std::string remedy =
      option.about.required
          ? fmt::format("give it as -{} VALUE", option.name)
          : fmt::format("correct it, or leave it out for the default: {}", option.initial);
  return {given, std::move(fault), option.allowed + unit, remedy};
}

const OptionSet::Option* OptionSet::find(std::string_view name) const {
  const auto found = std::ranges::find(m_options, name, &Option::name);
  return found == m_options.end() ? nullptr : &*found;
}

const OptionSet::Option& OptionSet::declared(std::string_view name) const {
  const Option* option = find(name);
  if (option == nullptr) throw std::logic_error(fmt::format("option -{} is not declared", name));
  return *option;
}

OptionSet::Option& OptionSet::known(const Given& given) {
  const auto found = std::ranges::find(m_options, given.name, &Option::name);
  if (found != m_options.end()) return *found;

  std::vector<std::string> names;
  for (const Option& option : m_options) names.push_back(option.name);
  names.insert(names.end(), {"options_file", "help", "version"});
  for (std::string& name : petsc_option_names()) names.push_back(std::move(name));
  const std::string foreign = fault_of_characters(given.name);
  throw bad_input(
      {.given = given,
       .fault = fmt::format("is an unknown option{}{}", foreign.empty() ? "" : " and ", foreign),
       .allowed = "the options that -help lists",
       .remedy = fmt::format("the nearest is -{}", nearest(given.name, names))});
}

bool OptionSet::is_given(std::string_view name) const {
  return !declared(name).origin.empty();
}

bool OptionSet::is_changed(std::string_view name) const {
  const Option& option = declared(name);
  return is_given(name) && option.present() != option.initial;
}

Given OptionSet::given(std::string_view name) const {
  const Option& option = declared(name);
  return {option.name, option.present(), option.origin.empty() ? "default" : option.origin};
}

std::vector<std::pair<std::string, std::string>> OptionSet::values() const {
  std::vector<std::pair<std::string, std::string>> all;
  for (const Option& option : m_options) all.emplace_back(option.name, option.present());
  return all;
}

}  // namespace mpm::options
