#include "mpm/options/CommandLine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>

#include "mpm/options/Characters.hpp"
#include "mpm/options/InputFile.hpp"
#include "mpm/options/PetscOptions.hpp"

namespace mpm::options {
namespace {

constexpr std::size_t largest_file = 1 << 20;
constexpr std::string_view pairs_allowed = "pairs of -name value";

struct Token {
  std::string text;
  bool quoted = false;
};

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

/// "-name" or "--name"; "-0.5" and "-inf" are values.
bool looks_like_name(std::string_view text) {
  if (!text.starts_with('-')) return false;
  const std::string word = lower_case(text.substr(text.starts_with("--") ? 2 : 1));
  if (word == "inf" || word == "infinity" || word == "nan") return false;
  return !word.empty() && std::isalpha(static_cast<unsigned char>(word.front())) != 0;
}

bool is_name(const Token& token) {
  return !token.quoted && looks_like_name(token.text);
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\f';
}

std::string name_of(const Token& token) {
  const std::string name = token.text.substr(1);
  if (name == "h" || name == "-help") return "help";
  return name == "-version" ? "version" : name;
}

BadInput stray_word(const Token& token, const std::vector<Given>& before,
                    const std::string& origin) {
  const std::string place = before.empty() ? "" : " after -" + before.back().name;
  const std::string foreign = fault_of_characters(token.text);
  return bad_input({.given = {"", token.text, origin},
                    .fault = fmt::format("is a stray word{}{}{}", place,
                                         foreign.empty() ? "" : " and ", foreign),
                    .allowed = std::string(pairs_allowed),
                    .remedy = "remove it, or put the value it belongs to in double quotes"});
}

void check_name(const Given& option) {
  const auto sign = option.name.find('=');
  if (sign == std::string::npos) return;
  throw bad_input({.given = option,
                   .fault = "has an equals sign in its name",
                   .allowed = std::string(pairs_allowed),
                   .remedy = fmt::format("write -{} {}", option.name.substr(0, sign),
                                         option.name.substr(sign + 1))});
}

bool takes_value(const Given& option) {
  return option.name != "help" && option.name != "version";
}

std::vector<Given> pair_up(std::span<const Token> tokens, const std::string& origin) {
  std::vector<Given> given;
  for (std::size_t k = 0; k < tokens.size(); ++k) {
    if (!is_name(tokens[k])) throw stray_word(tokens[k], given, origin);
    Given option{name_of(tokens[k]), "", origin};
    check_name(option);
    const bool has_value = k + 1 < tokens.size() && !is_name(tokens[k + 1]);
    if (has_value && takes_value(option)) option.value = tokens[++k].text;
    given.push_back(std::move(option));
  }
  return given;
}

std::vector<Token> tokens_of(std::string_view line, const std::string& origin) {
  std::vector<Token> tokens;
  bool in_quotes = false;
  bool in_token = false;
  for (const char c : line) {
    const bool separates = !in_quotes && is_blank(c);
    if (!in_token && c == '#') break;
    if (!in_token && !separates) tokens.emplace_back();
    in_token = !separates;
    if (separates) continue;
    if (c == '"') {
      tokens.back().quoted = true;
      in_quotes = !in_quotes;
    } else {
      tokens.back().text += c;
    }
  }
  if (in_quotes)
    throw bad_input({.given = {"", std::string(line), origin},
                     .fault = "has an opening double quote without a closing one",
                     .allowed = "values in double quotes on one line",
                     .remedy = "close the quote"});
  return tokens;
}

std::string does_not_start(const Token& token) {
  const std::string foreign = fault_of_characters(token.text);
  return "does not start an option" + (foreign.empty() ? "" : ": it " + foreign);
}

std::vector<Given> read_line(std::string_view line, const std::string& origin) {
  const std::vector<Token> tokens = tokens_of(line, origin);
  if (!tokens.empty() && !is_name(tokens.front()))
    throw bad_input({.given = {"", tokens.front().text, origin},
                     .fault = does_not_start(tokens.front()),
                     .allowed = "lines of one -name value, comments that start with #",
                     .remedy = "correct the line, or check that this is an options file"});
  std::vector<Given> given = pair_up(tokens, origin);
  if (given.size() > 1)
    throw bad_input({.given = given[1],
                     .fault = fmt::format("shares its line with -{}", given[0].name),
                     .allowed = "one option a line",
                     .remedy = "move it to a line of its own"});
  return given;
}

void refuse_nesting(const Given& option) {
  if (option.name != "options_file") return;
  throw bad_input({.given = option,
                   .fault = "stands inside an options file",
                   .allowed = "-options_file on the command line, several times if needed",
                   .remedy = "give both files on the command line"});
}

std::vector<Given> read_options_file(const Given& file) {
  std::string text;
  const std::string fault = load_text(file.value, largest_file, text);
  if (!fault.empty())
    throw bad_input({.given = file,
                     .fault = fault,
                     .allowed = "a readable text file with one -name value a line",
                     .remedy = "check the path"});
  std::vector<Given> given;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    for (Given& option : read_line(line, fmt::format("{}:{}", file.value, ++number))) {
      refuse_nesting(option);
      given.push_back(std::move(option));
    }
  }
  return given;
}

/// Refuses a name that has two values in one place.
void check_agreement(std::span<const Given> place) {
  for (auto later = place.begin(); later != place.end(); ++later) {
    const auto first = std::ranges::find(place.begin(), later, later->name, &Given::name);
    if (first == later || first->value == later->value) continue;
    throw bad_input(
        {.given = *later,
         .fault = fmt::format("contradicts the earlier '{}' ({})", first->value, first->origin),
         .allowed = "one value in one file or on one command line",
         .remedy = "remove one of the two"});
  }
}

void override_with(const std::vector<Given>& place, std::vector<Given>& all) {
  check_agreement(place);
  for (const Given& option : place) {
    const auto earlier = std::ranges::find(all, option.name, &Given::name);
    if (earlier == all.end())
      all.push_back(option);
    else
      *earlier = option;
  }
}

void check_petsc_value(const Given& option) {
  std::string allowed;
  const std::string fault = fault_of_petsc_value(option.name, option.value, allowed);
  if (fault.empty()) return;
  throw bad_input({.given = option,
                   .fault = fault,
                   .allowed = allowed,
                   .remedy = "correct it, or leave this option of PETSc out"});
}

CommandLine sorted_out(const std::vector<Given>& all) {
  CommandLine result;
  for (const Given& option : all) {
    if (option.name == "help")
      result.help = true;
    else if (option.name == "version")
      result.version = true;
    else
      (is_petsc_option(option.name) ? result.petsc : result.own).push_back(option);
    result.list_scenes |= option.name == "scene" && option.value == "list";
  }
  for (const Given& option : result.petsc) check_petsc_value(option);
  return result;
}

}  // namespace

std::optional<std::string> CommandLine::value_of(std::string_view name) const {
  const auto found = std::ranges::find(own, name, &Given::name);
  if (found == own.end()) return std::nullopt;
  if (!found->value.empty()) return found->value;
  throw bad_input({.given = *found,
                   .fault = "needs a value",
                   .allowed = std::string(pairs_allowed),
                   .remedy = fmt::format("write -{} VALUE, see -help", name)});
}

CommandLine read_command_line(std::span<const char* const> arguments) {
  std::vector<Token> tokens;
  for (const char* argument : arguments) tokens.push_back({argument});
  std::vector<Given> given = pair_up(tokens, Given::command_line);

  std::vector<Given> all;
  for (const Given& option : given)
    if (option.name == "options_file") override_with(read_options_file(option), all);
  std::erase_if(given, [](const Given& option) { return option.name == "options_file"; });
  override_with(given, all);
  return sorted_out(all);
}

std::string as_written(std::string_view value) {
  const bool plain =
      !value.empty() && value.find_first_of(" #") == value.npos && !looks_like_name(value);
  return plain ? std::string(value) : fmt::format("\"{}\"", value);
}

bool is_reserved(std::string_view name) {
  constexpr auto program =
      std::to_array<std::string_view>({"help", "h", "version", "options_file"});
  return is_petsc_option(name) || std::ranges::find(program, name) != program.end();
}

}  // namespace mpm::options
