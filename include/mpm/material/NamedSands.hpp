#pragma once

#include <span>
#include <string_view>

#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// A sand whose constants are known, for -sand NAME.
struct NamedSand {
  std::string_view name;
  std::string_view sentence;
  SandConstants constants;
};

/// The one table of sands: a new one is an entry here. The first is the default.
std::span<const NamedSand> named_sands();

}  // namespace mpm::material
