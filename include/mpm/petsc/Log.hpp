#pragma once

#include <petsclog.h>

#include <string>

namespace mpm::petsc {

/// From construction to destruction a phase of the step for PETSc's -log_view, an event of this
/// name. `name` must be a literal: events are found by its address.
class Phase {
 public:
  explicit Phase(const char* name);
  ~Phase();
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;

 private:
  PetscLogEvent m_event;
};

/// The same for a stage of the run. Collective.
class Stage {
 public:
  explicit Stage(const std::string& name);
  ~Stage();
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
};

}  // namespace mpm::petsc
