#include "ShapeOptions.hpp"

#include <fmt/format.h>

namespace mpm::cases::custom {

using geometry::shape_kinds;

void ShapeOptions::declare(options::OptionSet& set) {
  m_set = &set;
  m_prefix = set.prefix();
  for (std::size_t k = 0; k < shape_kinds().size(); ++k)
    set.real_list(std::string(shape_kinds()[k].name), m_numbers[k], {},
                  {"m", fmt::format("its shape, one is given; {}", shape_kinds()[k].sentence), ""});
}

std::vector<std::size_t> ShapeOptions::given_kinds() const {
  std::vector<std::size_t> given;
  for (std::size_t k = 0; k < m_numbers.size(); ++k)
    if (!m_numbers[k].empty()) given.push_back(k);
  return given;
}

std::string ShapeOptions::option(std::size_t kind) const {
  return m_prefix + std::string(shape_kinds()[kind].name);
}

template <int dim>
std::unique_ptr<geometry::Shape<dim>> ShapeOptions::create() const {
  const std::vector<std::size_t> given = given_kinds();
  if (given.empty())
    throw BadInput(fmt::format("-{}: no shape is given; give one of -{}, -{} or another of -help",
                               m_prefix.substr(0, m_prefix.size() - 1), option(0), option(1)));
  if (given.size() > 1)
    throw options::bad_input({m_set->given(option(given[1])),
                              fmt::format("is given beside -{}", option(given[0])), "one shape",
                              "leave one of them out"});
  try {
    return geometry::make_shape<dim>(given[0], m_numbers[given[0]]);
  } catch (const BadInput& error) {
    throw options::bad_input(
        {m_set->given(option(given[0])),
         fmt::format("makes no {}: {}", shape_kinds()[given[0]].name, error.what()),
         fmt::format("{}, with -dimension {}", shape_kinds()[given[0]].sentence, dim),
         "correct the numbers"});
  }
}

template std::unique_ptr<geometry::Shape<1>> ShapeOptions::create<1>() const;
template std::unique_ptr<geometry::Shape<2>> ShapeOptions::create<2>() const;
template std::unique_ptr<geometry::Shape<3>> ShapeOptions::create<3>() const;

}  // namespace mpm::cases::custom
