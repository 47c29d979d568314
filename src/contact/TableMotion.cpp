#include "mpm/contact/TableMotion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mpm/core/Errors.hpp"
#include "mpm/options/InputFile.hpp"

namespace mpm::contact {

template <int dim>
TableMotion<dim>::TableMotion(std::vector<Row> rows) : m_rows(std::move(rows)) {
  if (m_rows.empty()) throw BadInput("a motion without a row");
  for (std::size_t k = 1; k < m_rows.size(); ++k)
    if (!(m_rows[k].time > m_rows[k - 1].time))
      throw BadInput(fmt::format("times of a motion must increase: {} s comes after {} s",
                                 m_rows[k].time, m_rows[k - 1].time));
}

template <int dim>
BodyVelocity<dim> TableMotion<dim>::at(double time) const {
  const auto next = std::ranges::upper_bound(m_rows, time, {}, &Row::time);
  if (next == m_rows.begin()) return next->velocity;
  const Row& before = *(next - 1);
  if (next == m_rows.end()) return before.velocity;
  const double share = (time - before.time) / (next->time - before.time);
  BodyVelocity<dim> now;
  for (int d = 0; d < dim; ++d)
    now.translation[d] =
        std::lerp(before.velocity.translation[d], next->velocity.translation[d], share);
  now.spin = std::lerp(before.velocity.spin, next->velocity.spin, share);
  return now;
}

template <int dim>
TableMotion<dim> read_motion(std::string_view option, const std::string& path) {
  std::vector<typename TableMotion<dim>::Row> rows;
  constexpr std::size_t columns = dim + 1, most = dim == 2 ? columns + 1 : columns;
  for (const auto& [line, numbers] : options::read_number_lines(option, path)) {
    if (numbers.size() < columns || numbers.size() > most)
      throw BadInput(fmt::format("-{} {}:{} has {} numbers; needed are a time and {} velocities{}",
                                 option, path, line, numbers.size(), dim,
                                 dim == 2 ? ", and a spin if there is one" : ""));
    typename TableMotion<dim>::Row& row = rows.emplace_back();
    row.time = numbers[0];
    for (std::size_t d = 0; d < dim; ++d) row.velocity.translation[d] = numbers[1 + d];
    if (numbers.size() > columns) row.velocity.spin = numbers[columns];
  }
  try {
    return TableMotion<dim>(std::move(rows));
  } catch (const BadInput& error) {
    throw BadInput(fmt::format("-{} {}: {}", option, path, error.what()));
  }
}

template class TableMotion<1>;
template class TableMotion<2>;
template class TableMotion<3>;
template TableMotion<1> read_motion<1>(std::string_view, const std::string&);
template TableMotion<2> read_motion<2>(std::string_view, const std::string&);
template TableMotion<3> read_motion<3>(std::string_view, const std::string&);

}  // namespace mpm::contact
