#pragma once

#include "mpm/material/Material.hpp"
#include "mpm/material/SandParameters.hpp"

namespace mpm::material {

/// The -sand_* options.
class SandFactory : public MaterialFactory {
 public:
  void declare(options::OptionSet& set) override;
  std::unique_ptr<Material> create() const override;

  /// A scene may change defaults before declare().
  SandParameters& parameters() { return m_sand; }
  const SandParameters& parameters() const { return m_sand; }

 private:
  void declare_packing(options::OptionSet& set);
  void declare_elasticity(options::OptionSet& set);
  void declare_critical_state(options::OptionSet& set);
  void declare_hardening(options::OptionSet& set);
  void declare_cohesion(options::OptionSet& set);
  void declare_numerics(options::OptionSet& set);

  SandParameters m_sand;
};

}  // namespace mpm::material
