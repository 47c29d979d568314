#include "mpm/material/LinearElastic.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::material {

void LinearElasticFactory::declare(options::OptionSet& set) {
  const options::RealRange stable{
      .minimum = -1.0, .maximum = 0.5, .open_minimum = true, .open_maximum = true};
  set.section("Linear elastic material");
  set.real("elastic_youngs_modulus", m_parameters.youngs_modulus, options::positive(),
           {"Pa", "Young's modulus E.", "chosen"});
  set.real("elastic_poisson_ratio", m_parameters.poisson_ratio, stable,
           {"1", "Poisson's ratio nu.", "chosen"});
  set.real("elastic_density", m_parameters.density, options::positive(),
           {"kg/m^3", "Mass density of the undeformed material.", "chosen"});
}

std::unique_ptr<Material> LinearElasticFactory::create() const {
  return std::make_unique<LinearElastic>(m_parameters);
}

}  // namespace mpm::material
