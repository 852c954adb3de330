#pragma once

#include <vector>

#include "pliant/core/parameters.h"

namespace pliant {

/// What an item of a body's `attachments` has besides its name, its region and what it holds to.
std::vector<ParameterSpec> attachment_parameters();

}  // namespace pliant
