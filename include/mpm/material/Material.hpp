#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mpm/core/Tensor.hpp"

namespace mpm::options {
class OptionSet;
}

namespace mpm::material {

/// A symmetric tensor per particle, structure of arrays. A null pointer stands for a component
/// that is zero for all particles (yz and xz in plane strain).
template <class Scalar>
struct TensorView {
  std::array<Scalar*, SymmetricTensor::size> component{};

  SymmetricTensor load(std::size_t p) const {
    SymmetricTensor a;
    for (int k = 0; k < SymmetricTensor::size; ++k)
      if (auto* values = component[static_cast<std::size_t>(k)]) a[k] = values[p];
    return a;
  }
  void store(std::size_t p, const SymmetricTensor& a) const {
    for (int k = 0; k < SymmetricTensor::size; ++k)
      if (auto* values = component[static_cast<std::size_t>(k)]) values[p] = a[k];
  }
};

/// What a state variable does to the law.
enum class StateRole {
  plain,     ///< nothing that has to be known
  softening  ///< its growth makes the law weaker: averaged where a run is regularised
};

/// A quantity that a law keeps per particle. Declared once; registration, output, restart and
/// regularisation follow from it.
struct StateVariable {
  std::string name;       ///< identifier, e.g. "void_ratio"
  std::string long_name;  ///< for people, with the sign convention where there is one
  std::string unit;       ///< SI, "1" when dimensionless
  double initial;         ///< value of a new, unstressed particle
  StateRole role = StateRole::plain;
};

/// Views of the particles of one material. Stress and strain are tension positive.
struct Batch {
  std::size_t size = 0;
  TensorView<const double> strain_increment;  ///< D dt
  TensorView<double> stress;                  ///< Cauchy stress, Pa, already rotated
  std::vector<double*> state;                 ///< one array per state variable, in declared order
};

/// A rate-independent constitutive law. Knows neither grid nor MPI; every call is local.
class Material {
 public:
  virtual ~Material() = default;

  /// For messages; that of -material where the law can be chosen there.
  virtual std::string_view name() const = 0;

  virtual std::span<const StateVariable> state_variables() const = 0;

  /// Mass density of the undeformed material, kg/m^3.
  virtual double initial_density() const = 0;

  /// Advances stress and state by the strain increments. Leaves NaN in the stress where an
  /// increment cannot be integrated; the solver stops on it.
  virtual void update_stress(const Batch& batch) const = 0;

  /// Writes the present elastic modulus of longitudinal waves, K + 4G/3 in Pa.
  virtual void wave_modulus(const Batch& batch, std::span<double> modulus) const = 0;

  /// Sets the state of every particle of the batch to that of soil resting under its stress.
  /// Throws BadInput if the law admits no such stress.
  virtual void initialise_from_stress(const Batch& batch) const = 0;

  /// Whether the stress has a potential; a law whose moduli depend on the pressure need not.
  virtual bool has_strain_energy() const { return false; }
  /// Writes the energy that unloading would give back, J per m^3 of present volume. Only where
  /// has_strain_energy().
  virtual void strain_energy_density(const Batch&, std::span<double> /*density*/) const {}

  /// Number of particles whose law is held by a numerical limit (pressure floor, caps).
  virtual std::size_t count_at_limits(const Batch&) const { return 0; }
};

/// Options of a law and the law made from them.
class MaterialFactory {
 public:
  virtual ~MaterialFactory() = default;
  virtual void declare(options::OptionSet& set) = 0;
  /// Throws BadInput on combinations of options that make no sense together.
  virtual std::unique_ptr<Material> create() const = 0;
};

struct MaterialKind {
  std::string_view name;
  std::string_view sentence;
  std::unique_ptr<MaterialFactory> (*make_factory)();
};

/// The one table of laws: a new law is one file and one line here.
std::span<const MaterialKind> material_kinds();

}  // namespace mpm::material
