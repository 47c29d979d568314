#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mpm::options {

/// The text of a file that an option names. Throws BadInput, which names option and file, where it
/// is no file, larger than 16 MB, unreadable or not text.
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
