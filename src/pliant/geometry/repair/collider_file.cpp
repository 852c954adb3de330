#include "pliant/geometry/repair/collider_file.h"

#include <optional>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

/// What decides the mesh that a file holds: its bytes, and how they are read. Files of glTF as text
/// name others, so that what they hold has to be read.
std::string content_of(const std::string& path, std::optional<TriangleMesh>& mesh) {
  const std::string extension = checked_mesh_extension(path);
  if (extension != "gltf") return extension + '\n' + read_bytes(path);
  mesh = read_triangle_mesh(path);
  std::string bytes = "mesh\n";
  bytes.append(reinterpret_cast<const char*>(mesh->vertices.data()),
               static_cast<std::size_t>(mesh->vertices.size()) * sizeof(double));
  bytes.append(reinterpret_cast<const char*>(mesh->triangles.data()),
               static_cast<std::size_t>(mesh->triangles.size()) * sizeof(int));
  return bytes;
}

MeshCollider make_from_file(const std::string& path, std::optional<TriangleMesh> mesh,
                            const Eigen::Vector3d& scale, const ColliderOptions& options) {
  if (!mesh) mesh = read_triangle_mesh(path);
  mesh->vertices = scale.asDiagonal() * mesh->vertices;
  if (scale.prod() < 0.0) mesh->triangles.row(1).swap(mesh->triangles.row(2));
  try {
    return make_mesh_collider(*mesh, options);
  } catch (const InputError& error) {
    throw InputError("mesh '" + path + "': " + error.what());
  }
}

}  // namespace

MeshCollider load_mesh_collider(const std::string& path, const Eigen::Vector3d& scale,
                                const ColliderOptions& options, const ColliderCache& cache) {
  if (!scale.allFinite() || (scale.array() == 0.0).any()) {
    throw InputError("the mesh's scale must be finite and not 0");
  }
  std::optional<TriangleMesh> mesh;
  const ColliderKey key =
      collider_key(content_of(path, mesh), scale[0], scale[1], scale[2], options);
  std::string problem;
  std::optional<MeshCollider> collider = cache.read(key, problem);
  if (!collider) {
    collider = make_from_file(path, std::move(mesh), scale, options);
    cache.write(key, *collider, problem);
  }
  if (!problem.empty()) collider->note += "; " + problem;
  return std::move(*collider);
}

}  // namespace pliant
