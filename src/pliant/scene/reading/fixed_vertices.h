#pragma once

#include "pliant/core/body/region.h"
#include "pliant/scene/scene_spec.h"

namespace pliant {

/// What `region` of `body` means.
Region make_region(const RegionSpec& region, const BodySpec& body);

/// Fixes the particles that `body.fixed` picks; `particles` are where they are at the start.
/// Throws InputError "FILE:LINE: ..." for an index that is too large and a box or a sphere without
/// vertices.
void fix_vertices(const BodySpec& body, Particles& particles);

}  // namespace pliant
