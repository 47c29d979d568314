#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "CheckpointLayout.hpp"
#include "mpm/Version.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/core/Simd.hpp"
#include "mpm/io/Hdf5File.hpp"
#include "mpm/petsc/Log.hpp"
#include "mpm/run/Checkpoint.hpp"

namespace mpm::run {
namespace {

using Kind = Archive::Kind;

/// A whole list on the first rank.
template <class Number>
std::vector<std::int64_t> on_root(const petsc::Communicator& ranks,
                                  const std::vector<Number>& list) {
  if (!ranks.is_root()) return {};
  return std::vector<std::int64_t>(list.begin(), list.end());
}

template <class Points>
void write_points(io::Hdf5File& file, const char* group, const Points& points) {
  file.rows({layout::counts(group), "number of points of each rank", "1"},
            std::vector<std::int64_t>{points.local_count()}, 1);
  points.for_each_column([&](const std::string& name, auto values) {
    using Value = typename decltype(values)::element_type;
    file.rows({layout::column(group, name), "column of this name, rank by rank", "SI"},
              std::span<const Value>(values), 1);
  });
}

template <int dim>
void write_layout(io::Hdf5File& file, const grid::Grid<dim>& grid) {
  const partition::Ownership<dim>& cells = grid.ownership();
  for (int d = 0; d < dim; ++d)
    file.rows({layout::starts(d), "first cell of each block, and the number of cells", "1"},
              on_root(grid.communicator(), cells.starts(d)), 1);
  file.rows({layout::owners, "rank of each block, first direction fastest", "1"},
            on_root(grid.communicator(), cells.ranks()), 1);
}

/// FNV-1a of names and bits.
std::uint64_t digest(const Archive::Entries& entries) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&hash](std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3ULL; };
  for (const auto& [name, entry] : entries) {
    for (const char c : name) add(static_cast<unsigned char>(c));
    if (entry.kind != Kind::shared) continue;
    for (const double value : entry.values) add(std::bit_cast<std::uint64_t>(value));
  }
  return hash;
}

/// What all ranks should have alike, or a checkpoint would make of it what one has.
void check_agreement(const petsc::Communicator& ranks, const Archive::Entries& entries) {
  const auto differs = [&ranks](const Archive::Entries& some) {
    const std::string mine = std::to_string(digest(some));
    std::string first = mine;
    ranks.broadcast(first);
    return !ranks.all(mine == first);
  };
  if (!differs(entries)) return;
  for (const auto& [name, entry] : entries)
    if (differs({{name, entry}}))
      throw NumericalFailure(
          fmt::format("no checkpoint: ranks differ in '{}'; this is a fault of the program", name));
}

void write_archive(io::Hdf5File& file, const petsc::Communicator& ranks, const Archive& archive) {
  check_agreement(ranks, archive.values());
  nlohmann::ordered_json index{{"shared", nlohmann::json::array()},
                               {"each", nlohmann::json::array()}};
  std::vector<double> shared, each;
  std::vector<std::int64_t> sizes;
  for (const auto& [name, entry] : archive.values()) {
    const bool is_shared = entry.kind == Kind::shared;
    std::vector<double>& values = is_shared ? shared : each;
    values.insert(values.end(), entry.values.begin(), entry.values.end());
    if (is_shared)
      index["shared"].push_back({name, entry.values.size()});
    else
      index["each"].push_back({name, static_cast<int>(entry.kind)});
    if (!is_shared) sizes.push_back(static_cast<std::int64_t>(entry.values.size()));
  }
  file.text(layout::index, index.dump());
  if (!ranks.is_root()) shared.clear();
  file.rows({layout::shared, "what all ranks have alike, in the order of the index", "SI"}, shared,
            1);
  file.rows({layout::sizes, "numbers of values of each rank, in the order of the index", "1"},
            sizes, 1);
  file.rows({layout::each, "values of each rank", "SI"}, each, 1);
}

std::string header(const RunIdentity& identity, const CheckpointMoment& moment, int ranks,
                   int dimension) {
  nlohmann::ordered_json header;
  header["program"] = program_name();
  header["scene"] = identity.scene;
  header["dimension"] = dimension;
  header["ranks"] = ranks;
  header["step"] = moment.step;
  header["time_s"] = moment.time;
  header["options"] = nlohmann::json::array();
  for (const auto& [name, value] : identity.options) header["options"].push_back({name, value});
  return header.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

std::string program_name() {
  return fmt::format("{} ({}, {})", version, git_hash, simd::instruction_set);
}

template <int dim>
void write_checkpoint(const std::string& path, const RunIdentity& identity,
                      const CheckpointMoment& moment, const solver::Simulation<dim>& simulation,
                      const Archive& archive) {
  const petsc::Phase phase("mpm: checkpoint");
  const petsc::Communicator& ranks = simulation.communicator();
  io::Hdf5File file(path, ranks);
  file.attribute(layout::format_name, layout::format);
  file.text(layout::header, header(identity, moment, ranks.size(), dim));
  write_points(file, layout::particles, simulation.particles());
  write_points(file, layout::boundary, simulation.boundary());
  write_layout(file, simulation.grid());
  write_archive(file, ranks, archive);
  file.close(io::Durability::machine);
}

#define MPM_INSTANTIATE(dim)                                                                      \
  template void write_checkpoint(const std::string&, const RunIdentity&, const CheckpointMoment&, \
                                 const solver::Simulation<dim>&, const Archive&)
MPM_INSTANTIATE(1);
MPM_INSTANTIATE(2);
MPM_INSTANTIATE(3);
#undef MPM_INSTANTIATE

}  // namespace mpm::run
