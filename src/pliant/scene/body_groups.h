#pragma once

#include "pliant/core/world.h"
#include "pliant/scene/scene_spec.h"

namespace pliant {

/// Of a world that has its bodies and no effects yet: tells it what the scene says of pairs of
/// bodies, and groups those between which the effect `body_contact` acts, so that they are moved
/// together. Throws InputError for a pair that the effect cannot act on.
void group_bodies(const SceneSpec& scene, World& world);

}  // namespace pliant
