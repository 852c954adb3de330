#pragma once

#include <string>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// The closed surface of the solid that a mesh bounds, for a body; it passes validate(). A mesh
/// that is closed, and none of whose parts pass through each other, once make_sound() has mended
/// it, is used as that leaves it. Else the surface is made anew from sample_solid(), at 1/96 of
/// the longest side, with at most 20,000 triangles; its edges are rounded by about half a sample.
/// `note` says in one line what was wrong; "" where nothing was. The same bits for any number of
/// threads. `keep_holes`: a mesh whose only fault is that it is open is left so, for who closes its
/// holes, as stuff() does.
///
/// Throws InputError "it bounds no solid ...", with all faults of the mesh, where the samples are
/// not plausible, and as make_sound() does.
TriangleMesh make_body_surface(const TriangleMesh& mesh, std::string& note,
                               bool keep_holes = false);

}  // namespace pliant
