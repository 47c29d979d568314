#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mpm/material/Material.hpp"

namespace mpm::material {

/// What is prescribed of one component during an increment; the other follows from the law.
enum class Control { strain, stress };

/// A part of a loading path. Tension positive, components as in SymmetricTensor.
struct MixedIncrement {
  std::array<Control, SymmetricTensor::size> control{};
  SymmetricTensor change;  ///< of strain, or of stress in Pa, as `control` says
};

/// One material point under mixed control, without grid.
class MaterialPoint {
 public:
  /// Starts from the isotropic stress -`pressure`, Pa. Throws BadInput where the law does, and
  /// where it does not keep this stress at rest.
  MaterialPoint(const Material& material, double pressure);

  /// Follows the increment in small steps, each solved for the controlled stresses. Throws
  /// NumericalFailure where the law cannot follow.
  void apply(const MixedIncrement& increment);

  /// The path turns: the next step is sought from no strain, not from the step before. Past a peak
  /// a falling stress has two answers, softening and unloading; this finds the second.
  void turn() {
    m_last_step = {};
    m_tangent = {};
  }

  const SymmetricTensor& stress() const { return m_stress; }  ///< Pa, tension positive
  const SymmetricTensor& strain() const { return m_strain; }  ///< logarithmic, tension positive
  /// Present value of a state variable; none for a law without it.
  std::optional<double> state(std::string_view name) const;

 private:
  struct Response {
    SymmetricTensor stress;
    std::vector<double> state;
  };
  using Matrix = std::array<SymmetricTensor, SymmetricTensor::size>;

  void step(const MixedIncrement& increment, int halvings);
  [[noreturn]] void fail(const char* reason) const;
  bool solve(const MixedIncrement& increment, bool renew_tangent);
  Response respond(const SymmetricTensor& strain_increment) const;
  SymmetricTensor first_guess(const MixedIncrement& increment) const;
  SymmetricTensor misfit(const MixedIncrement& increment, const SymmetricTensor& strain,
                         const SymmetricTensor& stress) const;
  Matrix tangent(const MixedIncrement& increment, const SymmetricTensor& strain) const;
  SymmetricTensor derivative(SymmetricTensor strain, const SymmetricTensor& base, int component,
                             double difference) const;
  double number_of_steps(const MixedIncrement& increment) const;

  const Material& m_material;
  SymmetricTensor m_stress;
  SymmetricTensor m_strain;
  std::vector<double> m_state;
  int m_halvings = 0;           ///< that parts of increments need at present
  int m_clean_parts = 0;        ///< since these had to be more
  long long m_responses = 0;    ///< of the law in this increment
  SymmetricTensor m_last_step;  ///< strain increment of the step before
  Matrix m_tangent{};
};

enum class ElementTestKind {
  triaxial_compression,
  triaxial_extension,
  plane_strain,
  simple_shear_constant_volume,
  oedometer,
  path
};

/// A leg of a loading path: from the present state all controlled values go to their targets in
/// proportion.
struct PathLeg {
  std::array<Control, SymmetricTensor::size> control{};
  /// Stress in Pa or logarithmic strain at the end of the leg, tension positive; nothing holds the
  /// value that the leg begins with.
  std::array<std::optional<double>, SymmetricTensor::size> target{};
  std::size_t increments = 1;
  std::string origin;  ///< for messages, e.g. "path.csv:4"
};

struct ElementTestSettings {
  ElementTestKind kind = ElementTestKind::triaxial_compression;
  double confining_pressure = 150e3;  ///< Pa, the initial isotropic p in every test
  double strain_end = 0.3;            ///< axial, or engineering shear strain; a magnitude
  std::size_t increments = 150;
  std::vector<PathLeg> path{};  ///< of `ElementTestKind::path`, which ignores the two above
};

/// Compression positive but for the tensors. Axial is yy, out of plane zz.
struct ElementTestRow {
  double axial_strain;  ///< logarithmic; engineering shear strain in simple shear
  double q;             ///< Pa
  double p;             ///< Pa
  double volumetric_strain;
  double void_ratio;       ///< 0 for a law without voids
  double lode_angle_deg;   ///< -30 in triaxial compression, 0 where q vanishes
  SymmetricTensor stress;  ///< Pa, tension positive
  SymmetricTensor strain;  ///< logarithmic, tension positive
};

/// Row 0 is the initial state, then one row per increment. Throws BadInput where the settings make
/// no sense and NumericalFailure where the law cannot follow, naming leg and increment.
std::vector<ElementTestRow> run_element_test(const Material& material,
                                             const ElementTestSettings& settings);

}  // namespace mpm::material
