#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mpm/contact/Motion.hpp"

namespace mpm::contact {

/// Velocities between which it is linear in time; before the first time and after the last one
/// those hold.
template <int dim>
class TableMotion : public Motion<dim> {
 public:
  struct Row {
    double time;  ///< s
    BodyVelocity<dim> velocity;
  };

  /// Throws BadInput unless there is a row and times increase.
  explicit TableMotion(std::vector<Row> rows);

  BodyVelocity<dim> at(double time) const override;

 private:
  std::vector<Row> m_rows;
};

/// Reads rows of a time in s, velocities in m/s and, in the plane, a spin in rad/s where a row has
/// it, apart by blanks or commas; `#` begins a comment. Throws BadInput, which names option, file
/// and line.
template <int dim>
TableMotion<dim> read_motion(std::string_view option, const std::string& path);

extern template class TableMotion<1>;
extern template class TableMotion<2>;
extern template class TableMotion<3>;

}  // namespace mpm::contact
