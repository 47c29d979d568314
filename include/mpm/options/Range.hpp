#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace mpm::options {

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

inline RealRange positive() {
  return {.minimum = 0.0, .open_minimum = true};
}
inline RealRange not_negative() {
  return {.minimum = 0.0};
}
inline RealRange between(double minimum, double maximum) {
  return {minimum, maximum};
}
inline IntegerRange at_least(std::int64_t minimum) {
  return {.minimum = minimum};
}

/// "0 to 2", "> 0", ">= 1", "> 0 and <= 2"; empty when everything is allowed.
std::string describe(const RealRange& range);
std::string describe(const IntegerRange& range);

/// Reads the whole text into `value`. Returns what is wrong with it ("is out of range"), empty
/// when nothing is; `value` is touched only then.
std::string read(std::string_view text, const RealRange& allowed, double& value);
std::string read(std::string_view text, const IntegerRange& allowed, std::int64_t& value);
/// Reals separated by commas, at least one.
std::string read(std::string_view text, const RealRange& allowed, std::vector<double>& value);

}  // namespace mpm::options
