#include "mpm/run/History.hpp"

namespace mpm::run {

template <int dim>
template <class Value>
void History<dim>::insert_clock(std::vector<Value>& row, const std::array<Value, 2>& clock) const {
  const std::size_t place = std::min(m_table.columns_before_clock, row.size());
  row.insert(row.begin() + static_cast<std::ptrdiff_t>(place), clock.begin(), clock.end());
}

template <int dim>
void History<dim>::open(const Moment<dim>& moment) {
  if (m_file) return;
  std::vector<std::string> columns = m_table.columns;
  insert_clock<std::string>(columns, {"dt_s", "step"});
  if (m_table.has_ledger)
    for (const auto& [name, value] : solver::entries(moment.simulation.ledger()))
      columns.push_back("ledger_" + name);
  m_has_begun = true;
  m_file = std::make_unique<io::CsvFile>(m_table.path, columns, moment.simulation.communicator());
}

template <int dim>
void History<dim>::begin_stage(const Moment<dim>& moment) {
  const bool is_first = !m_file;
  open(moment);
  if (is_first && m_table.has_first_row) write_row(moment);
}

template <int dim>
void History<dim>::after_step(const Moment<dim>& moment) {
  if (m_table.cadence.is_due(moment)) write_row(moment);
}

template <int dim>
void History<dim>::go_on(const Moment<dim>& moment) {
  if (!m_has_begun) return;
  open(moment);
  for (std::size_t k = 0; k < m_rows.size(); ++k) write(m_rows[k], m_added[k]);
}

template <int dim>
void History<dim>::end(const Moment<dim>& moment) {
  open(moment);
  if (m_table.has_last_row) write_row(moment);
}

template <int dim>
void History<dim>::write_row(const Moment<dim>& moment) {
  m_rows.push_back(m_table.row(moment));
  std::vector<double> added{moment.clock.dt, static_cast<double>(moment.clock.step)};
  if (m_table.has_ledger)
    for (const auto& [name, value] : solver::entries(moment.simulation.ledger()))
      added.push_back(value);
  m_added.push_back(std::move(added));
  write(m_rows.back(), m_added.back());
}

template <int dim>
void History<dim>::write(const std::vector<double>& row, const std::vector<double>& added) {
  std::vector<double> all = row;
  insert_clock<double>(all, {added[0], added[1]});
  all.insert(all.end(), added.begin() + 2, added.end());
  m_file->row(all);
}

namespace {

/// Lists of equal length, one after another, saved or put back.
void persist_rows(Archive& archive, const std::string& name,
                  std::vector<std::vector<double>>& rows) {
  std::size_t width = rows.empty() ? 1 : rows.front().size();
  std::vector<double> values;
  for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
  archive(name + "_width", width);
  archive(name, values);
  if (!archive.gives()) return;
  rows.clear();
  for (std::size_t k = 0; k + width <= values.size(); k += width) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(k);
    rows.emplace_back(first, first + static_cast<std::ptrdiff_t>(width));
  }
}

}  // namespace

template <int dim>
void History<dim>::persist(Archive& archive) {
  m_table.cadence.persist(archive);
  archive("has_begun", m_has_begun);
  persist_rows(archive, "rows", m_rows);
  persist_rows(archive, "added", m_added);
}

template <int dim>
std::vector<double> History<dim>::column(std::size_t k) const {
  std::vector<double> values;
  for (const auto& row : m_rows) values.push_back(row[k]);
  return values;
}

template class History<1>;
template class History<2>;
template class History<3>;

}  // namespace mpm::run
