#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mpm::options {

/// Fills `text` with a file as it is, a mark at its beginning excepted, and returns what is wrong
/// with it ("does not exist"), empty when nothing is. Nothing but a regular file is opened: a pipe
/// would be read by one rank and awaited by the others.
std::string load_text(const std::string& path, std::size_t most_bytes, std::string& text);

/// The text of a file that an option names. Throws BadInput, which names option and file, where it
/// is no file, larger than 16 MiB, unreadable or not text.
std::string read_input_file(std::string_view option, const std::string& path);

/// The text after the mark that spreadsheets put at the beginning.
std::string_view without_byte_order_mark(std::string_view text);

/// Finite numbers of one line of a file.
struct NumberLine {
  std::size_t line;  ///< from 1
  std::vector<double> numbers;
};

/// Lines of numbers apart by blanks or commas; `#` begins a comment, lines without numbers are left
/// out. Throws BadInput that names option, file and line.
std::vector<NumberLine> read_number_lines(std::string_view option, const std::string& path);

}  // namespace mpm::options
