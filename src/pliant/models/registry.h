#pragma once

#include "pliant/core/body/model.h"

namespace pliant {

/// Every built-in model.
const ModelRegistry& model_registry();

}  // namespace pliant
