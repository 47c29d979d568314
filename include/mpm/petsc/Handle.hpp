#pragma once

#include <petscdm.h>
#include <petscsf.h>
#include <petscvec.h>

#include <utility>

namespace mpm::petsc {

/// Sole owner of a PETSc object. Destruction is collective where PETSc's is.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class Handle {
 public:
  Handle() = default;
  ~Handle() { reset(); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : m_object(std::exchange(other.m_object, nullptr)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(m_object, other.m_object);
    return *this;
  }

  operator Object() const { return m_object; }
  Object* address() { return &m_object; }
  /// Does nothing once PETSc has been finalized: the objects are gone with it.
  void reset() {
    PetscBool finalized = PETSC_FALSE;
    PetscFinalized(&finalized);
    if (m_object != nullptr && finalized == PETSC_FALSE) destroy(&m_object);
    m_object = nullptr;
  }

 private:
  Object m_object = nullptr;
};

using DmHandle = Handle<DM, DMDestroy>;
using VecHandle = Handle<Vec, VecDestroy>;
using StarForestHandle = Handle<PetscSF, PetscSFDestroy>;

}  // namespace mpm::petsc
