#pragma once

#include <string>
#include <string_view>

namespace mpm::options {

bool is_utf8(std::string_view text);

/// What is wrong with the first character beyond ASCII, where only ASCII can stand: "has the
/// character U+2212, which looks like '-'". Empty if there is none.
std::string fault_of_characters(std::string_view text);

/// What is wrong with bytes that should be the text of a file: "is UTF-16". Empty if nothing.
std::string fault_of_file_text(std::string_view bytes);

/// What is wrong with a path: not UTF-8, or written for a shell to complete. Empty if nothing.
std::string fault_of_path(std::string_view path);

/// As a message can show it: on one line, and not longer than a line or two.
std::string shown(std::string_view text);

}  // namespace mpm::options
