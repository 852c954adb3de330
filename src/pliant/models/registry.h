#pragma once

#include "pliant/core/model.h"

namespace pliant {

/// Every built-in model.
const ModelRegistry& model_registry();

}  // namespace pliant
