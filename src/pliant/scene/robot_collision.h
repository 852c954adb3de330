#pragma once

#include <urdf_model/link.h>

#include <memory>
#include <string>

#include "pliant/geometry/shape.h"
#include "pliant/scene/packages.h"

namespace pliant {

/// The shape of a URDF collision geometry; `urdf_path` ("" for none) is what relative mesh paths
/// are relative to. Throws InputError beginning with `where`.
std::shared_ptr<const Shape> make_collision_shape(const urdf::Geometry& geometry,
                                                  const std::string& urdf_path,
                                                  const PackageResolver& resolver,
                                                  const std::string& where);

}  // namespace pliant
