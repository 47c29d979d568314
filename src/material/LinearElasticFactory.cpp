#include "mpm/material/LinearElastic.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {

void declare_linear_elastic(options::OptionSet& set, const std::string& prefix,
                            LinearElasticParameters& parameters) {
  const options::RealRange stable{
      .minimum = -1.0, .maximum = 0.5, .open_minimum = true, .open_maximum = true};
  set.real(prefix + "_youngs_modulus", parameters.youngs_modulus, options::positive(),
           {"Pa", "Young's modulus E.", "chosen"});
  set.real(prefix + "_poisson_ratio", parameters.poisson_ratio, stable,
           {"1", "Poisson's ratio nu.", "chosen"});
  set.real(prefix + "_density", parameters.density, options::positive(),
           {"kg/m^3", "Mass density of the undeformed material.", "chosen"});
}

void LinearElasticFactory::declare(options::OptionSet& set) {
  set.section("Linear elastic material");
  declare_linear_elastic(set, "elastic", m_parameters);
}

std::unique_ptr<Material> LinearElasticFactory::create() const {
  return std::make_unique<LinearElastic>(m_parameters);
}

}  // namespace mpm::material
