#include "mpm/petsc/Log.hpp"

#include <unordered_map>

#include "mpm/petsc/Error.hpp"

namespace mpm::petsc {
namespace {

PetscClassId log_class() {
  static const PetscClassId id = [] {
    PetscClassId made = 0;
    MPM_PETSC(PetscClassIdRegister("mpmsolve", &made));
    return made;
  }();
  return id;
}

PetscLogEvent event_of(const char* name) {
  static std::unordered_map<const char*, PetscLogEvent> events;
  const auto [entry, is_new] = events.try_emplace(name, 0);
  if (is_new) MPM_PETSC(PetscLogEventRegister(name, log_class(), &entry->second));
  return entry->second;
}

PetscLogStage stage_of(const std::string& name) {
  PetscLogStage stage = -1;
  MPM_PETSC(PetscLogStageGetId(name.c_str(), &stage));
  if (stage < 0) MPM_PETSC(PetscLogStageRegister(name.c_str(), &stage));
  return stage;
}

}  // namespace

Phase::Phase(const char* name) : m_event(event_of(name)) {
  MPM_PETSC(PetscLogEventBegin(m_event, nullptr, nullptr, nullptr, nullptr));
}

Phase::~Phase() {
  PetscLogEventEnd(m_event, nullptr, nullptr, nullptr, nullptr);
}

Stage::Stage(const std::string& name) {
  MPM_PETSC(PetscLogStagePush(stage_of(name)));
}

Stage::~Stage() {
  PetscLogStagePop();
}

}  // namespace mpm::petsc
