#pragma once

#include <vector>

#include "pliant/core/body/heat_properties.h"
#include "pliant/core/parameters.h"

namespace pliant {

/// Those of the effect `heat` that a body's material may give for itself; negative: as the effect
/// says.
std::vector<ParameterSpec> heat_parameters();

/// What a material says of them. Throws InputError for what the effect would refuse.
HeatProperties heat_properties(const Parameters& given);

}  // namespace pliant
