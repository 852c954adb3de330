#include "pliant/scene/robot/robot_collision.h"

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/repair/collider_file.h"
#include "pliant/math/error.h"
#include "pliant/scene/yaml/place_error.h"

namespace pliant {
namespace {

CollisionShape make_mesh(const urdf::Mesh& mesh, const std::string& urdf_path,
                         const PackageResolver& resolver, ColliderKind collider,
                         const std::string& where) {
  ColliderOptions options;
  options.kind = collider;
  const MeshCollider made =
      load_mesh_collider(resolve_path(mesh.filename, urdf_path, resolver, where),
                         {mesh.scale.x, mesh.scale.y, mesh.scale.z}, options);
  return {made.shape, made.note};
}

std::shared_ptr<const Shape> make_primitive(const urdf::Geometry& geometry) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE:
      return std::make_shared<Sphere>(static_cast<const urdf::Sphere&>(geometry).radius);
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<const urdf::Box&>(geometry).dim;
      return std::make_shared<Box>(Eigen::Vector3d(size.x, size.y, size.z));
    }
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
      return std::make_shared<Cylinder>(cylinder.radius, cylinder.length);
    }
    default:
      break;
  }
  throw InputError("unknown geometry");
}

}  // namespace

CollisionShape make_collision_shape(const urdf::Geometry& geometry, const std::string& urdf_path,
                                    const PackageResolver& resolver, ColliderKind collider,
                                    const std::string& where) {
  return with_place(where, [&]() -> CollisionShape {
    if (geometry.type != urdf::Geometry::MESH) return {make_primitive(geometry), ""};
    return make_mesh(static_cast<const urdf::Mesh&>(geometry), urdf_path, resolver, collider,
                     where);
  });
}

}  // namespace pliant
