#pragma once

#include <optional>
#include <string>

#include "mpm/material/Material.hpp"
#include "mpm/material/NamedSands.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// The options -sand and -sand_*. Bound to the set that they are declared in, which outlives it.
class SandFactory : public MaterialFactory {
 public:
  void declare(options::OptionSet& set) override;
  std::unique_ptr<Material> create() const override;

  /// A scene may change defaults before declare().
  SandParameters& parameters() { return m_sand; }
  const SandParameters& parameters() const { return m_sand; }

 private:
  void declare_name(options::OptionSet& set);
  void declare_packing(options::OptionSet& set);
  void declare_elasticity(options::OptionSet& set);
  void declare_critical_state(options::OptionSet& set);
  void declare_hardening(options::OptionSet& set);
  void declare_readings(options::OptionSet& set);
  void declare_cohesion(options::OptionSet& set);
  void declare_numerics(options::OptionSet& set);

  void take(const NamedSand& sand);
  void check_together();
  void check_packing() const;
  std::string odd_packing() const;
  void set_packing();

  const options::OptionSet* m_options = nullptr;
  std::string m_prefix;  ///< of its options
  SandParameters m_sand;
  std::optional<double> m_relative_density;
};

}  // namespace mpm::material
