#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mpm::options {

/// The word that takes the fewest insertions, deletions and replacements to become `word`, the
/// first of equals; empty when there are no words.
std::string nearest(std::string_view word, std::span<const std::string> words);

}  // namespace mpm::options
