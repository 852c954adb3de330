#pragma once

#include <urdf_model/link.h>

#include <memory>
#include <string>

#include "pliant/geometry/distance/shape.h"
#include "pliant/geometry/repair/mesh_collider.h"
#include "pliant/scene/robot/packages.h"

namespace pliant {

struct CollisionShape {
  std::shared_ptr<const Shape> shape;
  std::string note;  ///< of a mesh: what collider it became, and why; else ""
};

/// The shape of a URDF collision geometry, a mesh's as `collider` says; `urdf_path` ("" for none)
/// is what relative mesh paths are relative to. Throws InputError beginning with `where`.
CollisionShape make_collision_shape(const urdf::Geometry& geometry, const std::string& urdf_path,
                                    const PackageResolver& resolver, ColliderKind collider,
                                    const std::string& where);

}  // namespace pliant
