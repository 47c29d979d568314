#include "ExplicitStep.hpp"
#include "mpm/basis/Bases.hpp"

namespace mpm::solver {
namespace {

/// Modified update stress last, the paper's Eqs. 1-9. Numbers are those of the equations.
template <int dim, class Basis>
class MuslStep : public ExplicitStep<dim, Basis> {
  using ExplicitStep<dim, Basis>::ExplicitStep;

  StepReport advance(const StepTimes& times, const StepOptions<dim>& options) override {
    const auto particles = this->particles();
    this->deposit(particles, options);                             // (1)-(5)
    this->update_momentum(particles, times, options);              // (6)
    this->update_velocities_and_remap(particles, times, options);  // (7), (9)
    return this->strain_and_move(particles, {.strain = times.dt, .move = times.dt},
                                 this->remapped_velocity(), options);  // (8)
  }
};

/// Without the second mapping: what the forces have just done to light nodes strains the particles.
template <int dim, class Basis>
class UslStep : public ExplicitStep<dim, Basis> {
  using ExplicitStep<dim, Basis>::ExplicitStep;

  StepReport advance(const StepTimes& times, const StepOptions<dim>& options) override {
    const auto particles = this->particles();
    this->deposit(particles, options);                   // (1)-(5)
    this->update_momentum(particles, times, options);    // (6)
    this->update_velocities(particles, times, options);  // (7)
    return this->strain_and_move(particles, {.strain = times.dt, .move = times.dt},
                                 this->updated_velocity(), options);  // (8)
  }
};

/// Strains of the interval before, from velocities mapped at its end, come first.
template <int dim, class Basis>
class UsfStep : public ExplicitStep<dim, Basis> {
  using ExplicitStep<dim, Basis>::ExplicitStep;

  StepReport advance(const StepTimes& times, const StepOptions<dim>& options) override {
    const auto particles = this->particles();
    this->deposit(particles, options);  // (1), (2)
    this->take_deposited_velocities();
    const StepReport strained = this->strain_and_move(
        particles, {.strain = times.dt_old, .move = 0.0}, this->remapped_velocity(), options);
    this->deposit(particles, options);                   // (1)-(5)
    this->update_momentum(particles, times, options);    // (6)
    this->update_velocities(particles, times, options);  // (7)
    StepReport moved = this->strain_and_move(particles, {.strain = 0.0, .move = times.dt},
                                             this->updated_velocity(), options);  // (8)
    if (strained.broken_particle >= 0) moved.broken_particle = strained.broken_particle;
    return moved;
  }
};

}  // namespace

template <int dim, class Basis>
std::unique_ptr<Step<dim>> make_step(Scheme scheme, const StepParts<dim, Basis>& parts) {
  switch (scheme) {
    case Scheme::musl:
      return std::make_unique<MuslStep<dim, Basis>>(parts);
    case Scheme::usl:
      return std::make_unique<UslStep<dim, Basis>>(parts);
    case Scheme::usf:
      return std::make_unique<UsfStep<dim, Basis>>(parts);
  }
  return nullptr;  // not reached
}

#define MPM_INSTANTIATE(dim, Basis) \
  template std::unique_ptr<Step<dim>> make_step(Scheme, const StepParts<dim, Basis>&);
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::solver
