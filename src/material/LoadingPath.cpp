#include "mpm/material/LoadingPath.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>

#include "mpm/core/Errors.hpp"
#include "mpm/options/InputFile.hpp"
#include "mpm/options/Nearest.hpp"
#include "mpm/options/Range.hpp"

namespace mpm::material {

namespace {

constexpr int size = SymmetricTensor::size;
constexpr std::int64_t most_increments = 10'000'000;
constexpr double largest_strain = 5.0;
constexpr double largest_stress = 1e12;  // Pa
constexpr int increments_column = -1;

/// What a column holds: a component under one control, in the units and the sign of the file.
struct Column {
  std::string_view name;
  int component;
  Control control;
  double factor;  ///< from the file's value to the tensor component, tension positive
};

constexpr std::array columns{
    Column{"increments", increments_column, Control::strain, 1.0},
    Column{"strain_xx", 0, Control::strain, -1.0},
    Column{"strain_yy", 1, Control::strain, -1.0},
    Column{"strain_zz", 2, Control::strain, -1.0},
    Column{"gamma_xy", 3, Control::strain, 0.5},
    Column{"gamma_yz", 4, Control::strain, 0.5},
    Column{"gamma_xz", 5, Control::strain, 0.5},
    Column{"stress_xx_Pa", 0, Control::stress, -1.0},
    Column{"stress_yy_Pa", 1, Control::stress, -1.0},
    Column{"stress_zz_Pa", 2, Control::stress, -1.0},
    Column{"stress_xy_Pa", 3, Control::stress, 1.0},
    Column{"stress_yz_Pa", 4, Control::stress, 1.0},
    Column{"stress_xz_Pa", 5, Control::stress, 1.0},
};

constexpr std::array<std::string_view, size> component_names{"xx", "yy", "zz", "xy", "yz", "xz"};

std::vector<std::string> column_names() {
  std::vector<std::string> names;
  for (const Column& column : columns) names.emplace_back(column.name);
  return names;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t comma = std::min(line.find(',', start), line.size());
    fields.push_back(trimmed(line.substr(start, comma - start)));
    start = comma + 1;
  }
  return fields;
}

class PathReader {
 public:
  explicit PathReader(std::string name) : m_name(std::move(name)) {}

  std::vector<PathLeg> read(const std::string& text) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      ++m_line;
      const std::string_view content = trimmed(std::string_view(line).substr(0, line.find('#')));
      if (content.empty()) continue;
      if (m_header.empty())
        read_header(fields_of(content));
      else
        read_leg(fields_of(content));
    }
    if (m_legs.empty())
      refuse_file(
          "has no legs; allowed: a header that names the columns, then one line for each leg");
    return std::move(m_legs);
  }

 private:
  [[noreturn]] void refuse_file(const std::string& fault) const {
    throw BadInput(fmt::format("-path_file {} {}", m_name, fault));
  }
  [[noreturn]] void refuse(const std::string& fault) const {
    throw BadInput(fmt::format("-path_file {}:{} {}", m_name, m_line, fault));
  }

  void read_header(const std::vector<std::string_view>& names) {
    for (const std::string_view name : names) {
      const Column& column = find(name);
      if (std::ranges::find(m_header, &column) != m_header.end())
        refuse(fmt::format("names the column '{}' twice; allowed: once", name));
      m_header.push_back(&column);
    }
    if (std::ranges::find(m_header, &columns[0]) == m_header.end())
      refuse(
          "names no column 'increments'; add it: into how many rows of the result each leg goes");
  }

  const Column& find(std::string_view name) const {
    for (const Column& column : columns)
      if (column.name == name) return column;
    const auto names = column_names();
    refuse(fmt::format("names an unknown column '{}'; allowed: {}; the nearest is {}", name,
                       fmt::join(names, ", "), options::nearest(name, names)));
  }

  void read_leg(const std::vector<std::string_view>& fields) {
    if (fields.size() != m_header.size())
      refuse(
          fmt::format("has {} fields; allowed: {}, one for each column of the header; leave a "
                      "field between two commas empty for what is not controlled",
                      fields.size(), m_header.size()));
    PathLeg leg;
    leg.origin = fmt::format("{}:{}", m_name, m_line);
    std::array<const Column*, size> controlled_by{};
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const Column& column = *m_header[k];
      if (column.component == increments_column)
        leg.increments = read_increments(fields[k]);
      else if (!fields[k].empty())
        control(leg, column, fields[k], controlled_by);
    }
    for (std::size_t k = 0; k < 3; ++k)
      if (!controlled_by[k])
        refuse(
            fmt::format("controls neither strain nor stress of {0}; give strain_{0} or "
                        "stress_{0}_Pa a value or the word hold",
                        component_names[k]));
    m_legs.push_back(leg);
  }

  std::size_t read_increments(std::string_view field) {
    std::int64_t increments = 0;
    const std::string fault = options::read(field, {1, most_increments}, increments);
    if (!fault.empty())
      refuse(fmt::format("increments '{}' {}; allowed: integer, 1 to {}", field, fault,
                         most_increments));
    m_increments += increments;
    if (m_increments > most_increments)
      refuse(fmt::format("makes {} increments together; allowed: {} in all", m_increments,
                         most_increments));
    return static_cast<std::size_t>(increments);
  }

  void control(PathLeg& leg, const Column& column, std::string_view field,
               std::array<const Column*, size>& controlled_by) const {
    const auto k = static_cast<std::size_t>(column.component);
    if (controlled_by[k])
      refuse(
          fmt::format("controls {} by {} and by {}; allowed: one of them in a leg, the other "
                      "field empty",
                      component_names[k], controlled_by[k]->name, column.name));
    controlled_by[k] = &column;
    leg.control[k] = column.control;
    if (field == "hold")
      leg.target[k].reset();
    else
      leg.target[k] = column.factor * read_target(column, field);
  }

  double read_target(const Column& column, std::string_view field) const {
    const double largest = column.control == Control::strain ? largest_strain : largest_stress;
    double value = 0.0;
    const std::string fault = options::read(field, {-largest, largest}, value);
    if (!fault.empty())
      refuse(
          fmt::format("{} '{}' {}; allowed: real, {} to {}, the word hold, or nothing where "
                      "the other control is given",
                      column.name, field, fault, -largest, largest));
    return value;
  }

  std::string m_name;
  std::size_t m_line = 0;
  std::int64_t m_increments = 0;
  std::vector<const Column*> m_header;
  std::vector<PathLeg> m_legs;
};

}  // namespace

std::vector<PathLeg> read_path(const std::string& text, const std::string& name) {
  return PathReader(name).read(std::string(options::without_byte_order_mark(text)));
}

std::vector<PathLeg> read_path_file(const std::string& path) {
  return read_path(options::read_input_file("path_file", path), path);
}

}  // namespace mpm::material
