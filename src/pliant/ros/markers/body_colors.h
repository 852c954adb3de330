#pragma once

#include "pliant/scene/scene.h"

namespace pliant {

/// Gives bodies whose colour the scene leaves open colours that differ, but for the first, which
/// keeps its own.
void color_apart(LoadedScene& scene);

}  // namespace pliant
