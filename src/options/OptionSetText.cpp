#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "mpm/options/CommandLine.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::options {
namespace {

constexpr std::size_t line_width = 100;
constexpr std::size_t sentence_indent = 6;
constexpr std::size_t widest_head = 44;
constexpr std::size_t widest_used = 44;

/// Breaks text at blanks; `indent` goes in front of all lines but the first, which has room for
/// `line_width - indent` characters like the others.
std::string wrapped(std::string_view text, std::size_t indent) {
  std::string lines;
  while (!text.empty()) {
    std::size_t length = text.size();
    if (length > line_width - indent) {
      length = text.rfind(' ', line_width - indent);
      if (length == std::string_view::npos) length = std::min(text.find(' '), text.size());
    }
    if (!lines.empty()) lines.append("\n").append(indent, ' ');
    lines += text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return lines;
}

std::string joined(std::string_view first, std::string_view separator, std::string_view second) {
  return fmt::format("{}{}{}", first, first.empty() || second.empty() ? "" : separator, second);
}

std::string unit_of(const About& about) {
  return about.is_dimensionless() ? "-" : about.unit;
}

std::string head(std::string_view name, std::string_view initial) {
  return fmt::format("  -{} <{}>", name, initial);
}

}  // namespace

std::string_view word_for(Kind kind) {
  constexpr std::array words{"real", "integer", "text",      "path",  "input_file",
                             "flag", "choice",  "real_list", "words", "names"};
  return words.at(static_cast<std::size_t>(kind));
}

std::string OptionSet::by_section(const std::function<std::string(const std::string&)>& heading,
                                  const std::function<std::string(const Option&)>& entry) const {
  std::string text;
  const std::string* section = nullptr;
  for (const Option& option : m_options) {
    if (section == nullptr || *section != option.section)
      text.append(section == nullptr ? "" : "\n").append(heading(option.section));
    section = &option.section;
    text += entry(option);
  }
  return text;
}

std::string OptionSet::help_entry(const Option& option, std::size_t head_width,
                                  std::size_t unit_width) {
  std::string start = head(option.name, option.initial);
  if (start.size() > head_width) start.append("\n").append(head_width, ' ');
  const std::string source =
      option.about.source.empty() ? "" : fmt::format("[{}]", option.about.source);
  return fmt::format("{:<{}}  {:<{}}  {}\n{:{}}{}\n", start, head_width, unit_of(option.about),
                     unit_width, wrapped(option.allowed, head_width + unit_width + 4), "",
                     sentence_indent,
                     wrapped(joined(option.about.sentence, " ", source), sentence_indent));
}

std::string OptionSet::help() const {
  std::size_t head_width = 0;
  std::size_t unit_width = 0;
  for (const Option& option : m_options) {
    head_width = std::max(head_width, head(option.name, option.initial).size());
    unit_width = std::max(unit_width, unit_of(option.about).size());
  }
  head_width = std::min(head_width, widest_head);
  return by_section([](const std::string& title) { return title + "\n"; },
                    [=](const Option& o) { return help_entry(o, head_width, unit_width); });
}

std::string OptionSet::used_line(const Option& option) {
  const std::string value = option.present();
  if (value.empty()) return fmt::format("# -{}: {}", option.name, option.when_absent);
  return fmt::format("{}-{} {}", option.is_left_out ? "# " : "", option.name, as_written(value));
}

std::string OptionSet::used() const {
  std::size_t width = 0;
  for (const Option& option : m_options) width = std::max(width, used_line(option).size());
  width = std::min(width, widest_used);
  const auto entry = [width](const Option& option) {
    const std::string unit = option.about.is_dimensionless() ? "" : option.about.unit;
    return fmt::format("{:<{}}  # {}\n", used_line(option), width,
                       joined(unit, "; ", option.about.sentence));
  };
  return by_section([](const std::string& title) { return "# " + title + "\n"; }, entry);
}

std::vector<Row> OptionSet::rows() const {
  std::vector<Row> all;
  for (const Option& option : m_options)
    all.push_back({.section = option.section,
                   .name = option.name,
                   .kind = option.kind,
                   .range = option.range,
                   .words = option.words,
                   .initial = option.initial,
                   .unit = unit_of(option.about),
                   .allowed = option.allowed,
                   .sentence = option.about.sentence,
                   .source = option.about.source});
  return all;
}

}  // namespace mpm::options
