#pragma once

#include <memory>
#include <vector>

#include "pliant/core/coupling.h"
#include "pliant/core/element_set.h"
#include "pliant/core/particles.h"

namespace pliant {

/// What a solver moves. A solver never knows which model it belongs to.
class System {
 public:
  virtual ~System() = default;
};

/// Particles tied by element sets: cloth, patch, the solid half of viscoelastic.
class ProjectiveSystem final : public System {
 public:
  Particles particles;
  std::vector<std::unique_ptr<ElementSet>> elements;
  std::vector<Coupling*> couplings;  ///< owned by the effects that brought them
  Forces external_forces;            ///< gravity, wind, the user's: set anew every step [N]

  double elastic_energy() const;  ///< [J]
};

}  // namespace pliant
