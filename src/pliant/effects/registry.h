#pragma once

#include "pliant/core/effect.h"

namespace pliant {

/// Every built-in effect.
const EffectRegistry& effect_registry();

}  // namespace pliant
