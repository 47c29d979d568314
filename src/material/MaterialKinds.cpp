#include <array>

#include "mpm/material/LinearElastic.hpp"
#include "mpm/material/Material.hpp"
#include "mpm/material/MohrCoulomb.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/material/VonMises.hpp"

namespace mpm::material {

namespace {

template <class Factory>
std::unique_ptr<MaterialFactory> make() {
  return std::make_unique<Factory>();
}

constexpr std::array kinds{
    MaterialKind{"sand", "J2-deformation sand with state-dependent dilatancy (Eqs. 12-26)",
                 &make<SandFactory>},
    MaterialKind{"elastic", "Isotropic linear elasticity in rate form",
                 &make<LinearElasticFactory>},
    MaterialKind{"von_mises", "Linear elastic, perfectly plastic von Mises solid",
                 &make<VonMisesFactory>},
    MaterialKind{"mohr_coulomb",
                 "Linear elastic, perfectly plastic Mohr-Coulomb solid with dilation",
                 &make<MohrCoulombFactory>},
};

}  // namespace

std::span<const MaterialKind> material_kinds() {
  return kinds;
}

}  // namespace mpm::material
