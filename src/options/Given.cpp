#include "mpm/options/Given.hpp"

#include <fmt/format.h>

namespace mpm::options {
namespace {

std::string subject(const Given& given) {
  if (given.name.empty()) return fmt::format("'{}'", given.value);
  if (given.value.empty()) return "-" + given.name;
  return fmt::format("-{} {}", given.name, given.value);
}

}  // namespace

BadInput bad_input(const Refusal& refusal) {
  return BadInput{fmt::format("{} ({}) {}; allowed: {}; {}", subject(refusal.given),
                              refusal.given.origin, refusal.fault, refusal.allowed,
                              refusal.remedy)};
}

}  // namespace mpm::options
