#pragma once

#include <Eigen/Core>
#include <string>

#include "pliant/geometry/repair/collider_cache.h"

namespace pliant {

/// The collider of a mesh file, whose lengths are multiplied by `scale` along x, y and z. One that
/// the cache has from the same bytes, scale and options is not made again, and the file is not even
/// parsed; the result has the same bits. What the cache could not do stands at the end of the note.
/// Throws InputError as read_triangle_mesh() and, beginning with "mesh '<path>'", as
/// make_mesh_collider() do, and for a scale that is 0 or not finite.
MeshCollider load_mesh_collider(const std::string& path, const Eigen::Vector3d& scale,
                                const ColliderOptions& options,
                                const ColliderCache& cache = ColliderCache());

}  // namespace pliant
