#include <array>
#include <stdexcept>

#include "GapDetection.hpp"
#include "ParticleDetection.hpp"
#include "VelocityDetection.hpp"

namespace mpm::contact {
namespace {

template <int dim, template <int> class Method>
std::unique_ptr<Detection<dim>> make(const DetectionParts<dim>& parts) {
  return std::make_unique<Method<dim>>(parts);
}

template <template <int> class Method>
constexpr DetectionKind kind(std::string_view name, std::string_view sentence) {
  return {name, sentence, &make<1, Method>, &make<2, Method>, &make<3, Method>};
}

constexpr std::array kinds{
    kind<VelocityDetection>("velocity", "where they share nodes and approach (the paper)"),
    kind<GapDetection>("gap", "on nodes within -contact_gap_cells of the rigid body"),
    kind<ParticleDetection>("particle",
                            "on those if most particles beside the surface there touch it"),
    DetectionKind{"spring", "where a particle's own extent meets the rigid body (springs)", nullptr,
                  nullptr, nullptr},
};

}  // namespace

std::span<const DetectionKind> detection_kinds() {
  return kinds;
}

std::size_t detection_named(std::string_view name) {
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (kinds[k].name == name) return k;
  throw std::out_of_range("no such detection: " + std::string(name));
}

}  // namespace mpm::contact
