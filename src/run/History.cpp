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
void History<dim>::end(const Moment<dim>& moment) {
  open(moment);
  if (m_table.has_last_row) write_row(moment);
}

template <int dim>
void History<dim>::write_row(const Moment<dim>& moment) {
  std::vector<double> row = m_table.row(moment);
  m_rows.push_back(row);
  insert_clock<double>(row, {moment.clock.dt, static_cast<double>(moment.clock.step)});
  if (m_table.has_ledger)
    for (const auto& [name, value] : solver::entries(moment.simulation.ledger()))
      row.push_back(value);
  m_file->row(row);
}

template <int dim>
void History<dim>::persist(Archive& archive) {
  m_table.cadence.persist(archive);
  std::vector<double> values;
  for (const auto& row : m_rows) values.insert(values.end(), row.begin(), row.end());
  archive("rows", values);
  if (!archive.gives()) return;
  m_rows.clear();
  const auto width = static_cast<std::ptrdiff_t>(m_table.columns.size());
  for (auto row = values.begin(); row != values.end(); row += width)
    m_rows.emplace_back(row, row + width);
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
