#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/geometry/distance/mesh_shape.h"

namespace pliant {

/// What solid a mesh stands for.
enum class ColliderKind {
  kAuto,       ///< the first of the others that suits the mesh
  kExact,      ///< what its closed surface bounds
  kRepaired,   ///< what its surface bounds once its holes are closed and its inner walls are gone
  kConvex,     ///< its convex hull
  kThickShell  ///< all points near its surface
};

/// "auto", "exact", "repaired", "convex", "thick_shell".
const std::vector<std::string>& collider_names();
std::string collider_name(ColliderKind kind);
/// Throws InputError with the nearest name for one that there is none of.
ColliderKind find_collider(const std::string& name);

struct ColliderOptions {
  ColliderKind kind = ColliderKind::kAuto;
  /// As in MeshShapeOptions. With 0, a solid too thin for 1/64 of the mesh's longest side is
  /// sampled up to four times finer.
  double voxel_size = 0.0;
  double thickness = 0.0;  ///< of a thick shell [m]; 0: two voxels
};

struct MeshCollider {
  std::shared_ptr<const MeshShape> shape;
  ColliderKind kind = ColliderKind::kExact;  ///< what it became; not kAuto
  std::string note;                          ///< the kind, and why; one line
};

/// A solid from any mesh that has an area. `kAuto` is exact where the mesh is closed once vertices
/// at one place are joined, triangles that repeat others are dropped and turned ones are turned
/// back; repaired where at most a quarter of the solid's surface has to close holes, and at most a
/// tenth of the mesh bounds nothing; else the convex hull where the mesh lies within 2 % of its
/// longest side of it; else a thick shell. The same bits for any number of threads.
///
/// Throws InputError, with all faults of the mesh, where it has no vertices, no triangles with an
/// area, vertices that are not finite or indices out of range, where options are out of range, and
/// where the kind that is asked for is not to be had.
MeshCollider make_mesh_collider(const TriangleMesh& mesh, const ColliderOptions& options = {});

}  // namespace pliant
