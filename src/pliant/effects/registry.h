#pragma once

#include "pliant/core/effect.h"

namespace pliant {

/// Every effect: Pliant's own, and those that were added.
const EffectRegistry& effect_registry();

/// Adds one of another package, before a scene is loaded. It acts after all others. Throws
/// InputError where the name is taken.
void add_effect(EffectRegistry::Entry entry);

}  // namespace pliant
