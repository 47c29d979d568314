#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mpm/io/TextFile.hpp"
#include "mpm/run/Cadence.hpp"

namespace mpm::run {

/// A table that grows with the run.
template <int dim>
struct HistoryTable {
  std::string path;
  std::vector<std::string> columns;  ///< names with units
  /// The values of a row. Collective.
  std::function<std::vector<double>(const Moment<dim>&)> row;
  Cadence<dim> cadence;
  bool has_first_row = false;  ///< one before the first step of the main stage
  bool has_last_row = false;   ///< one when the run is over
};

/// Writes a row of a table whenever it is due, and keeps it. dt_s and step follow as last columns.
template <int dim>
class History : public Observer<dim> {
 public:
  explicit History(HistoryTable<dim> table) : m_table(std::move(table)) {}

  void begin_stage(const Moment<dim>& moment) override;
  void after_step(const Moment<dim>& moment) override;
  void end(const Moment<dim>& moment) override;
  void persist(Archive& archive) override;

  /// Rows so far, without dt and step.
  const std::vector<std::vector<double>>& rows() const { return m_rows; }
  /// The last value of column k, or `before` where there is none yet.
  double last(std::size_t k, double before = 0.0) const {
    return m_rows.empty() ? before : m_rows.back()[k];
  }

 private:
  void open();
  void write_row(const Moment<dim>& moment);

  HistoryTable<dim> m_table;
  std::unique_ptr<io::CsvFile> m_file;
  std::vector<std::vector<double>> m_rows;
};

extern template class History<1>;
extern template class History<2>;
extern template class History<3>;

}  // namespace mpm::run
