#pragma once

#include <vector>

#include "pliant/core/system/constraint.h"

namespace pliant {

/// What one of the constraints offers (math/offers.h), the first that does; or null.
template <class Service>
Service* find_constraint(const std::vector<Constraint*>& constraints) {
  for (Constraint* constraint : constraints) {
    if (auto* found = constraint->find<Service>()) return found;
  }
  return nullptr;
}

}  // namespace pliant
