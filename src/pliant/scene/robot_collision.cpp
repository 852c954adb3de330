#include "pliant/scene/robot_collision.h"

#include <cmath>

#include "pliant/geometry/mesh_file.h"
#include "pliant/geometry/mesh_shape.h"
#include "pliant/geometry/primitive_shapes.h"
#include "pliant/math/error.h"
#include "pliant/scene/place_error.h"

namespace pliant {
namespace {

std::shared_ptr<const Shape> make_mesh(const urdf::Mesh& mesh, const std::string& urdf_path,
                                       const PackageResolver& resolver, const std::string& where) {
  const Eigen::Vector3d scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  if (!scale.allFinite() || (scale.array() == 0.0).any()) {
    throw InputError("the mesh's scale must be finite and not 0");
  }
  const std::string path = resolve_path(mesh.filename, urdf_path, resolver, where);
  TriangleMesh triangles = read_triangle_mesh(path);
  triangles.vertices = scale.asDiagonal() * triangles.vertices;
  return with_place(path, [&] { return std::make_shared<MeshShape>(std::move(triangles)); });
}

std::shared_ptr<const Shape> make_shape(const urdf::Geometry& geometry,
                                        const std::string& urdf_path,
                                        const PackageResolver& resolver, const std::string& where) {
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
    case urdf::Geometry::MESH:
      return make_mesh(static_cast<const urdf::Mesh&>(geometry), urdf_path, resolver, where);
  }
  throw InputError("unknown geometry");
}

}  // namespace

std::shared_ptr<const Shape> make_collision_shape(const urdf::Geometry& geometry,
                                                  const std::string& urdf_path,
                                                  const PackageResolver& resolver,
                                                  const std::string& where) {
  return with_place(where, [&] { return make_shape(geometry, urdf_path, resolver, where); });
}

}  // namespace pliant
