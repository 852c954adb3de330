#pragma once

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Turns triangles so that neighbours agree, and each piece of surface outward: a closed one by its
/// volume (one within another as that one is turned), an open one to where rays from it come
/// farther (Takayama et al. 2014, "A simple method for correcting facet orientations in polygon
/// meshes based on ray casting"). Pieces end at edges that have another number of triangles than
/// two. Returns how many shells there are: sets of triangles that hang together.
int turn_outward(TriangleMesh& mesh);

}  // namespace pliant
