#include <array>

#include "mpm/contact/CoulombFriction.hpp"
#include "mpm/contact/RoughSurface.hpp"

namespace mpm::contact {
namespace {

template <int dim, template <int> class Law>
std::unique_ptr<FrictionLaw<dim>> make(const FrictionParameters& parameters) {
  return std::make_unique<Law<dim>>(parameters);
}

template <template <int> class Law>
constexpr FrictionKind kind(std::string_view name, std::string_view sentence) {
  return {name, sentence, &make<1, Law>, &make<2, Law>, &make<3, Law>};
}

constexpr std::array kinds{
    kind<CoulombFriction>("coulomb", "slides where the shear passes mu times the pressure"),
    kind<RoughSurface>("rough", "nothing slides while the surfaces touch"),
};

}  // namespace

std::span<const FrictionKind> friction_kinds() {
  return kinds;
}

}  // namespace mpm::contact
