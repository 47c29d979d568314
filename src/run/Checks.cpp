#include "mpm/run/Checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace mpm::run {
namespace {

std::string in_words(const Check& check, double value, double limit) {
  return fmt::format("{}: {:.3g}, more than {} (-check_{}); {}", check.sentence, value, limit,
                     check.name, check.remedy);
}

}  // namespace

void Checks::declare(options::OptionSet& options) {
  options.section("Checks of the answer");
  for (Check& check : m_checks) {
    const std::string name = "check_" + check.name;
    options.real_list(
        name, check.limits, options::not_negative(),
        {check.unit,
         check.sentence + "; beyond the first number there is a warning, beyond the second no "
                          "answer",
         "docs/checks.md"});
    options.rule([&options, &check, name] {
      if (check.limits.size() == 2 && check.limits[0] <= check.limits[1]) return;
      throw options::bad_input({options.given(name), "is no pair of rising limits",
                                "two numbers, the first not above the second",
                                "1e30,1e30 leaves the check out"});
    });
  }
}

void Checks::hold(const std::string& name, const Measured& measured, io::Summary& summary) const {
  const auto check = std::ranges::find(m_checks, name, &Check::name);
  if (check == m_checks.end()) throw std::out_of_range("no such check: " + name);
  summary.set("check_" + name, measured.to_end);
  if (!(measured.to_answer <= check->limits[1]))
    summary.withhold(in_words(*check, measured.to_answer, check->limits[1]));
  else if (!(measured.to_end <= check->limits[0]))
    summary.warn(in_words(*check, measured.to_end, check->limits[0]));
}

}  // namespace mpm::run
