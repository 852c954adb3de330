#pragma once

#include <vector>

#include "pliant/core/parameters.h"
#include "pliant/models/reduced/reduced_model.h"

namespace pliant {

/// What a scene may say of an example body: name, scale, young, poisson, density, modes, rank.
std::vector<ParameterSpec> scene_example_parameters();

/// Makes and reduces it. Throws InputError for a number of modes or a rank that it does not have.
ReducedModel reduce_scene_example(const Parameters& parameters);

}  // namespace pliant
