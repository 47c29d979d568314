#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

/// Names in the file of a checkpoint; docs/restart.md says what is in it.
namespace mpm::run::layout {

/// Goes up whenever a program could no longer read what another has written.
inline constexpr std::int64_t format = 2;
inline constexpr auto format_name = "mpmsolve_checkpoint";

inline constexpr auto header = "header";
inline constexpr auto particles = "particles";
inline constexpr auto boundary = "boundary_particles";
inline constexpr auto owners = "cells/ranks";
inline constexpr auto index = "archive/index";
inline constexpr auto shared = "archive/shared";
inline constexpr auto sizes = "archive/sizes";
inline constexpr auto each = "archive/each";

inline std::string column(const char* group, const std::string& name) {
  return fmt::format("{}/{}", group, name);
}
inline std::string counts(const char* group) {
  return fmt::format("{}_of_ranks", group);
}
inline std::string starts(int d) {
  return fmt::format("cells/starts_{}", "xyz"[d]);
}

}  // namespace mpm::run::layout
