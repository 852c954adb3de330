#pragma once

#include <string>

#include "pliant/scene/scene_spec.h"

namespace pliant {

/// Names what a batch is made of: the scene with all files it names, the table (its path; "" none),
/// the settings, this version of Pliant. Throws InputError for a file that cannot be read.
std::string batch_hash(const SceneSpec& scene, const std::string& table,
                       const std::string& settings);

}  // namespace pliant
