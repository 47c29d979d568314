#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mpm/geometry/ShapeKinds.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::cases::custom {

/// An option for each shape of the table, of which one is given. Stays where it is.
class ShapeOptions {
 public:
  ShapeOptions() : m_numbers(geometry::shape_kinds().size()) {}

  /// Declares them with the prefix in force.
  void declare(options::OptionSet& set);
  /// Throws BadInput where none or several are given, or the numbers make no such shape.
  template <int dim>
  std::unique_ptr<geometry::Shape<dim>> create() const;

 private:
  std::vector<std::size_t> given_kinds() const;
  std::string option(std::size_t kind) const;

  const options::OptionSet* m_set = nullptr;
  std::string m_prefix;
  std::vector<std::vector<double>> m_numbers;  ///< of each row of the table
};

}  // namespace mpm::cases::custom
