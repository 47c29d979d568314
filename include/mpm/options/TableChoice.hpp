#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace mpm::options {

/// The names of a table's rows with their numbers, for OptionSet::choice.
template <class Table>
std::vector<std::pair<std::string, std::size_t>> rows_by_name(const Table& table) {
  std::vector<std::pair<std::string, std::size_t>> rows;
  for (const auto& row : table) rows.emplace_back(std::string(row.name), rows.size());
  return rows;
}

}  // namespace mpm::options
