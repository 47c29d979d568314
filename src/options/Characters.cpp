#include "mpm/options/Characters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

namespace mpm::options {
namespace {

constexpr std::size_t longest_shown = 160;

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t bytes = 0;  ///< none where the text is not UTF-8
};

/// Of the first character; neither overlong forms nor surrogates are UTF-8.
CodePoint first_of(std::string_view text) {
  constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const auto byte = [text](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const std::size_t bytes = byte(0) < 0x80 ? 1 : byte(0) < 0xE0 ? 2 : byte(0) < 0xF0 ? 3 : 4;
  if (bytes == 1) return {byte(0), 1};
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < bytes) return {};
  std::uint32_t value = byte(0) & (0xFFU >> (bytes + 1));
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0U) != 0x80) return {};
    value = value << 6 | (byte(k) & 0x3FU);
  }
  const bool is_surrogate = value >= 0xD800 && value <= 0xDFFF;
  return value < smallest[bytes] || is_surrogate || value > 0x10FFFF ? CodePoint{}
                                                                     : CodePoint{value, bytes};
}

/// What a character that is not ASCII is taken for; empty if for nothing in particular.
std::string meaning(std::uint32_t code) {
  if ((code >= 0x2010 && code <= 0x2015) || code == 0x2212 || code == 0xFE58 || code == 0xFE63 ||
      code == 0xFF0D)
    return "looks like '-'";
  if (code == 0xA0 || (code >= 0x2000 && code <= 0x200B) || code == 0x202F || code == 0x205F ||
      code == 0x3000 || code == 0xFEFF)
    return "is no ordinary blank";
  if (code > 0xFF00 && code < 0xFF5F)
    return fmt::format("looks like '{}'", static_cast<char>(code - 0xFF00 + 0x20));
  if ((code >= 0x2018 && code <= 0x201F) || code == 0xAB || code == 0xBB)
    return "is no ordinary quote";
  return "";
}

bool is_foreign(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f') || byte == 0x7f;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = first_of(text).bytes;
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string fault_of_characters(std::string_view text) {
  const auto first =
      std::ranges::find_if(text, [](char c) { return static_cast<unsigned char>(c) >= 0x80; });
  if (first == text.end()) return "";
  const CodePoint code = first_of(text.substr(static_cast<std::size_t>(first - text.begin())));
  if (code.bytes == 0) return "has bytes in it that are no text (UTF-8)";
  const std::string what = meaning(code.value);
  return fmt::format("has the character U+{:04X} in it{}{}", code.value,
                     what.empty() ? "" : ", which ", what);
}

std::string fault_of_file_text(std::string_view bytes) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    return "is UTF-16 text: save it as UTF-8";
  return std::ranges::any_of(bytes, is_foreign) ? "is not a text file" : "";
}

std::string fault_of_path(std::string_view path) {
  if (!is_utf8(path)) return "is no text (UTF-8)";
  if (path.starts_with('~')) return "begins with ~, which only a shell replaces";
  for (std::size_t k = path.find('$'); k < path.size(); k = path.find('$', k + 1)) {
    const char next = k + 1 < path.size() ? path[k + 1] : ' ';
    if (next == '{' || next == '(' || next == '_' ||
        std::isalpha(static_cast<unsigned char>(next)) != 0)
      return "has a $ in it, whose variable only a shell replaces";
  }
  return "";
}

std::string shown(std::string_view text) {
  std::string line;
  while (!text.empty() && line.size() < longest_shown) {
    const CodePoint code = first_of(text);
    const bool plain = code.value >= 0x20 && code.value != 0x7f && code.bytes > 0;
    const std::size_t bytes = std::max<std::size_t>(1, code.bytes);
    if (plain)
      line += text.substr(0, bytes);
    else
      line += fmt::format("\\x{:02X}", static_cast<unsigned char>(text[0]));
    text.remove_prefix(bytes);
  }
  return text.empty() ? line : line + fmt::format("... ({} more bytes)", text.size());
}

}  // namespace mpm::options
