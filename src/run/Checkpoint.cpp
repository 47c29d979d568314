#include "mpm/run/Checkpoint.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>

#include "CheckpointLayout.hpp"
#include "mpm/core/Errors.hpp"
#include "mpm/io/Hdf5Input.hpp"

namespace mpm::run {
namespace {

constexpr auto begin_anew = "leave -restart out to begin anew";

std::vector<int> as_ints(const std::vector<std::int64_t>& list) {
  std::vector<int> ints;
  for (const std::int64_t value : list) ints.push_back(static_cast<int>(value));
  return ints;
}

/// What a rank that there was has saved becomes what one that there is needs.
void join(Archive::Entry& entry, const std::vector<double>& of_another) {
  if (entry.kind == Archive::Kind::list)
    entry.values.insert(entry.values.end(), of_another.begin(), of_another.end());
  else if (entry.values.size() != of_another.size())
    throw std::runtime_error("has lists of unlike lengths: it is damaged");
  for (std::size_t k = 0; k < of_another.size(); ++k) {
    if (entry.kind == Archive::Kind::sum) entry.values[k] += of_another[k];
    if (entry.kind == Archive::Kind::largest)
      entry.values[k] = std::max(entry.values[k], of_another[k]);
  }
}

}  // namespace

std::string checkpoint_path(const std::string& output_dir) {
  return output_dir + "/checkpoint.h5";
}

std::optional<std::string> checkpoint_to_go_on_from(const CheckpointOptions& options,
                                                    const std::string& output_dir,
                                                    const petsc::Communicator& ranks) {
  if (options.restart.empty()) return {};
  if (options.restart != restart_if_possible) return options.restart;
  const std::string path = checkpoint_path(output_dir);
  std::error_code ignored;  // what cannot be seen is not there
  const bool is_there = !ranks.is_root() || std::filesystem::exists(path, ignored);
  return ranks.all(is_there) ? std::optional(path) : std::nullopt;
}

template <class Read>
void Checkpoint::on_all(const Read& read) const {
  std::string fault;
  try {
    read();
  } catch (const std::exception& error) {
    fault = error.what();
  }
  fault = m_ranks.first_text(fault);
  if (!fault.empty())
    refuse(fault, fmt::format("name a checkpoint that mpmsolve has written, or {}", begin_anew));
}

void Checkpoint::refuse(const std::string& fault, const std::string& remedy) const {
  throw BadInput(fmt::format("-restart: the file '{}' {}; {}", m_path, fault, remedy));
}

Checkpoint::Checkpoint(std::string path, const petsc::Communicator& ranks)
    : m_path(std::move(path)), m_ranks(ranks) {
  on_all([this] { m_file = std::make_unique<io::Hdf5Input>(m_path); });
  on_all([this] { read_header(); });
}

Checkpoint::~Checkpoint() = default;

void Checkpoint::read_header() {
  if (!m_file->has_attribute(layout::format_name))
    throw std::runtime_error("is no checkpoint of mpmsolve");
  const std::int64_t format = m_file->attribute(layout::format_name);
  if (format != layout::format)
    throw std::runtime_error(
        fmt::format("has format {} of checkpoints, and this program reads format {} only", format,
                    layout::format));
  const auto header = nlohmann::json::parse(m_file->text(layout::header));
  m_identity.scene = header.at("scene");
  for (const auto& option : header.at("options"))
    m_identity.options.emplace_back(option.at(0), option.at(1));
  m_program = header.at("program");
  m_moment = {header.at("step"), header.at("time_s")};
  m_saved_ranks = header.at("ranks");
  m_dimension = header.at("dimension");
}

void Checkpoint::check(const RunIdentity& identity) const {
  if (identity.scene != m_identity.scene)
    refuse(fmt::format("is of -scene {}, and this is -scene {}", m_identity.scene, identity.scene),
           "name one of the same scene");
  const std::map<std::string, std::string> saved(m_identity.options.begin(),
                                                 m_identity.options.end());
  for (const auto& [name, value] : identity.options) {
    const auto before = saved.find(name);
    const std::string then = before == saved.end() ? "" : before->second;
    if (then == value || may_change_on_restart(name)) continue;
    const auto shown = [](const std::string& text) { return text.empty() ? "not set" : text; };
    refuse(fmt::format("was made with -{0} {1}, and this run has -{0} {2}", name, shown(then),
                       shown(value)),
           fmt::format("give it as it was; what may change when a run goes on: {}",
                       options_that_may_change()));
  }
}

/// Of this rank: what it had, or an equal share.
Checkpoint::Slab Checkpoint::slab_of(const char* group) const {
  const auto counts = m_file->read_all<std::int64_t>(layout::counts(group));
  if (counts.size() != static_cast<std::size_t>(m_saved_ranks))
    throw std::runtime_error("does not say how many particles ranks had: it is damaged");
  const auto rank = static_cast<std::ptrdiff_t>(m_ranks.rank());
  const auto before = [&](std::ptrdiff_t ranks) {
    return std::accumulate(counts.begin(), counts.begin() + ranks, std::int64_t{0});
  };
  if (is_on_same_ranks())
    return {before(rank), static_cast<int>(counts[static_cast<std::size_t>(rank)])};
  const std::int64_t all = before(m_saved_ranks), ranks = m_ranks.size();
  const std::int64_t first = all * rank / ranks, end = all * (rank + 1) / ranks;
  return {first, static_cast<int>(end - first)};
}

template <class Points>
void Checkpoint::put_back_points(const char* group, Points& points) const {
  Slab slab;
  on_all([&] { slab = slab_of(group); });
  points.replace(slab.count);
  on_all([&] {
    points.for_each_column([&](const std::string& name, auto values) {
      m_file->read(layout::column(group, name), slab.first, values);
    });
  });
}

template <int dim>
partition::Ownership<dim> Checkpoint::ownership() const {
  std::array<std::vector<int>, dim> starts;
  for (int d = 0; d < dim; ++d)
    starts[d] = as_ints(m_file->read_all<std::int64_t>(layout::starts(d)));
  return {std::move(starts), as_ints(m_file->read_all<std::int64_t>(layout::owners))};
}

template <int dim>
void Checkpoint::put_back(solver::Simulation<dim>& simulation) const {
  if (dim != m_dimension)
    refuse(fmt::format("is of a problem in {} dimensions, and this one has {}", m_dimension, dim),
           "name one of the same problem");
  put_back_points(layout::particles, simulation.particles());
  put_back_points(layout::boundary, simulation.boundary());
  if (!is_on_same_ranks()) return simulation.share_out();
  on_all([&] {
    const partition::Ownership<dim> saved = ownership<dim>();
    if (saved.cells() != simulation.grid().ownership().cells())
      throw std::runtime_error("is of another grid");
    simulation.keep_layout(saved);
  });
}

Archive::Entries Checkpoint::read_entries() const {
  const auto index = nlohmann::json::parse(m_file->text(layout::index));
  Archive::Entries entries;
  long long place = 0;
  const auto take = [&](const char* set, std::int64_t size) {
    std::vector<double> values(static_cast<std::size_t>(size));
    m_file->read(set, place, std::span(values));
    place += size;
    return values;
  };
  for (const auto& one : index.at("shared"))
    entries[one.at(0)] = {Archive::Kind::shared, take(layout::shared, one.at(1))};
  const auto sizes = m_file->read_all<std::int64_t>(layout::sizes);
  const auto& each = index.at("each");
  if (sizes.size() != each.size() * static_cast<std::size_t>(m_saved_ranks))
    throw std::runtime_error("has an index that does not fit: it is damaged");
  place = 0;
  for (std::size_t rank = 0, k = 0; rank < static_cast<std::size_t>(m_saved_ranks); ++rank)
    for (const auto& one : each) {
      Archive::Entry entry{static_cast<Archive::Kind>(one.at(1).get<int>()),
                           take(layout::each, sizes[k++])};
      const bool mine = is_on_same_ranks() && static_cast<int>(rank) == m_ranks.rank();
      const auto [known, is_new] = entries.try_emplace(one.at(0), entry);
      if (mine)
        known->second = entry;
      else if (!is_new && !is_on_same_ranks() && entry.kind != Archive::Kind::own)
        join(known->second, entry.values);
    }
  return entries;
}

/// On other ranks the first one keeps the sums of all.
Archive Checkpoint::archive() const {
  Archive::Entries entries;
  on_all([&] { entries = read_entries(); });
  if (!is_on_same_ranks() && !m_ranks.is_root())
    for (auto& [name, entry] : entries)
      if (entry.kind == Archive::Kind::sum)
        std::fill(entry.values.begin(), entry.values.end(), 0.0);
  return Archive(std::move(entries), is_on_same_ranks());
}

template void Checkpoint::put_back(solver::Simulation<1>&) const;
template void Checkpoint::put_back(solver::Simulation<2>&) const;
template void Checkpoint::put_back(solver::Simulation<3>&) const;

}  // namespace mpm::run
