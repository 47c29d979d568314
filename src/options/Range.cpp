#include "mpm/options/Range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <concepts>
#include <utility>

#include "mpm/options/Characters.hpp"

namespace mpm::options {
namespace {

template <class Number>
bool contains(const Range<Number>& range, Number value) {
  const bool above = range.open_minimum ? value > range.minimum : value >= range.minimum;
  const bool below = range.open_maximum ? value < range.maximum : value <= range.maximum;
  return above && below;
}

template <class Number>
std::string describe_range(const Range<Number>& range) {
  const bool bounded_below = range.minimum != std::numeric_limits<Number>::lowest();
  const bool bounded_above = range.maximum != std::numeric_limits<Number>::max();
  const bool closed = !range.open_minimum && !range.open_maximum;
  if (bounded_below && bounded_above && closed)
    return fmt::format("{} to {}", range.minimum, range.maximum);

  std::string above = fmt::format("{} {}", range.open_minimum ? ">" : ">=", range.minimum);
  std::string below = fmt::format("{} {}", range.open_maximum ? "<" : "<=", range.maximum);
  if (bounded_below && bounded_above) return above + " and " + below;
  if (bounded_below) return above;
  return bounded_above ? below : "";
}

std::string_view without_plus(std::string_view text) {
  const bool plus = text.size() > 1 && text[0] == '+' && text[1] != '-';
  return plus ? text.substr(1) : text;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Why text that is no number looks like one; empty where it does not.
std::string slip_in(std::string_view text) {
  if (const std::string foreign = fault_of_characters(text); !foreign.empty())
    return foreign.starts_with("has") ? "it " + foreign : foreign;
  const std::string_view bare = text.substr(text.starts_with('-') || text.starts_with('+') ? 1 : 0);
  if (bare.starts_with("0x") || bare.starts_with("0X")) return "write it as a decimal number";
  if (bare.empty() || !(is_digit(bare[0]) || bare[0] == '.')) return "";
  double ignored = 0.0;
  const char* const end = bare.data() + bare.size();
  const char* const stop = std::from_chars(bare.data(), end, ignored).ptr;
  if (stop != end && *stop == ',') return "the decimal sign is a point";
  if (stop != end && std::isalpha(static_cast<unsigned char>(*stop)) != 0)
    return fmt::format("the unit is fixed, leave '{}' away",
                       shown({stop, static_cast<std::size_t>(end - stop)}));
  return "";
}

std::string no_number(std::string_view kind, std::string_view text) {
  const std::string slip = slip_in(text);
  return fmt::format("is not {}{}{}", kind, slip.empty() ? "" : ": ", slip);
}

template <class Number>
std::string read_number(std::string_view text, const Range<Number>& allowed, Number& value) {
  constexpr bool real = std::floating_point<Number>;
  const std::string_view digits = without_plus(text);
  const char* const end = digits.data() + digits.size();
  Number number{};
  const auto [stop, error] = std::from_chars(digits.data(), end, number);
  if (error == std::errc::invalid_argument || stop != end)
    return no_number(real ? "a real number" : "an integer", text);
  if (error == std::errc::result_out_of_range) return "does not fit in 64 bits";
  if constexpr (real)
    if (!std::isfinite(number)) return "is not finite";
  if (!contains(allowed, number)) return "is out of range";
  value = number;
  return {};
}

}  // namespace

std::string describe(const RealRange& range) {
  return describe_range(range);
}
std::string describe(const IntegerRange& range) {
  return describe_range(range);
}

std::string read(std::string_view text, const RealRange& allowed, double& value) {
  return read_number(text, allowed, value);
}

std::string read(std::string_view text, const IntegerRange& allowed, std::int64_t& value) {
  return read_number(text, allowed, value);
}

std::string read(std::string_view text, const RealRange& allowed, std::vector<double>& value) {
  std::vector<double> numbers;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    const std::string_view entry = trimmed(text.substr(start, comma - start));
    start = comma + 1;
    const std::string fault = read_number(entry, allowed, numbers.emplace_back());
    if (!fault.empty()) return fmt::format("has an entry '{}' that {}", entry, fault);
  }
  value = std::move(numbers);
  return {};
}

}  // namespace mpm::options
