#pragma once

#include "pliant/core/particles.h"
#include "pliant/scene/scene_spec.h"

namespace pliant {

/// Fixes the particles that `body.fixed` picks; `particles` are where they are at the start.
/// Throws InputError "FILE:LINE: ..." for an index that is too large and a box without vertices.
void fix_vertices(const BodySpec& body, Particles& particles);

}  // namespace pliant
