#pragma once

#include "pliant/core/body/model.h"
#include "pliant/core/system/system.h"

namespace pliant {

/// Of a model that projective solvers take.
inline ProjectiveSystem& projective_system(Model& model) {
  return dynamic_cast<ProjectiveSystem&>(model.system());
}
inline const ProjectiveSystem& projective_system(const Model& model) {
  return dynamic_cast<const ProjectiveSystem&>(model.system());
}

}  // namespace pliant
