#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "mpm/io/TextFile.hpp"
#include "mpm/run/Cadence.hpp"

namespace mpm::run {

template <int dim>
class History;

/// A table that grows with the run.
template <int dim>
struct HistoryTable {
  std::string path;
  std::vector<std::string> columns;  ///< names with units
  /// The values of a row. Collective.
  std::function<std::vector<double>(const Moment<dim>&)> row;
  Cadence<dim> cadence;
  /// For the progress line, from the rows so far.
  std::function<std::string(const History<dim>&)> status = {};
  /// Columns before dt_s and step, which the history adds; the others follow.
  std::size_t columns_before_clock = std::numeric_limits<std::size_t>::max();
  bool has_first_row = false;  ///< one before the first step of the main stage
  bool has_last_row = false;   ///< one when the run is over
  /// The ledger of momentum and energy in the last columns: see docs/ledger.md.
  bool has_ledger = false;
};

/// Writes a row of a table whenever it is due, and keeps it. Adds dt_s and step.
template <int dim>
class History : public Observer<dim> {
 public:
  explicit History(HistoryTable<dim> table) : m_table(std::move(table)) {}

  void begin_stage(const Moment<dim>& moment) override;
  void after_step(const Moment<dim>& moment) override;
  /// Writes the table as far as it had come.
  void go_on(const Moment<dim>& moment) override;
  void end(const Moment<dim>& moment) override;
  std::string status() const override { return m_table.status ? m_table.status(*this) : ""; }
  void persist(Archive& archive) override;

  /// Rows so far, without dt and step.
  const std::vector<std::vector<double>>& rows() const { return m_rows; }
  std::vector<double> column(std::size_t k) const;
  /// The last value of column k, or `before` where there is none yet.
  double last(std::size_t k, double before = 0.0) const {
    return m_rows.empty() ? before : m_rows.back()[k];
  }

 private:
  template <class Value>
  void insert_clock(std::vector<Value>& row, const std::array<Value, 2>& clock) const;
  void open(const Moment<dim>& moment);
  void write_row(const Moment<dim>& moment);
  void write(const std::vector<double>& row, const std::vector<double>& added);

  HistoryTable<dim> m_table;
  std::unique_ptr<io::CsvFile> m_file;
  std::vector<std::vector<double>> m_rows;
  std::vector<std::vector<double>> m_added;  ///< to each row: dt, step, ledger
  bool m_has_begun = false;
};

extern template class History<1>;
extern template class History<2>;
extern template class History<3>;

}  // namespace mpm::run
