#include "mpm/options/Given.hpp"

#include <fmt/format.h>

#include "mpm/options/Characters.hpp"

namespace mpm::options {
namespace {

std::string subject(const Given& given) {
  if (given.name.empty()) return fmt::format("'{}'", shown(given.value));
  if (given.value.empty()) return fmt::format("-{}", shown(given.name));
  return fmt::format("-{} {}", shown(given.name), shown(given.value));
}

}  // namespace

BadInput bad_input(const Refusal& refusal) {
  return BadInput{fmt::format("{} ({}) {}; allowed: {}; {}", subject(refusal.given),
                              shown(refusal.given.origin), refusal.fault, refusal.allowed,
                              refusal.remedy)};
}

}  // namespace mpm::options
