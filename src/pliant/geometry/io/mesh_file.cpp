#include "pliant/geometry/io/mesh_file.h"

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cstring>
#include <vector>

#include "pliant/geometry/io/child_process.h"
#include "pliant/geometry/io/guarded_io.h"
#include "pliant/geometry/io/readable_file.h"
#include "pliant/geometry/mesh/polygon.h"
#include "pliant/geometry/mesh/vertex_welder.h"
#include "pliant/geometry/mesh_checks/mesh_checks.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

const std::vector<std::string> kExtensions = {"obj", "stl", "ply", "gltf", "glb", "dae"};

// What assimp would trust a file with.
void check_content(const std::string& path, const std::string& extension) {
  if (extension == "obj" || extension == "stl") return;
  const std::string bytes = read_bytes(path);
  if (extension == "ply") {
    check_ply(path, bytes);
  } else if (extension == "dae") {
    check_collada(path, bytes);
  } else {
    check_gltf(path, bytes, extension == "glb");
  }
}

// Gathers the triangles of a scene's nodes. Assimp's own steps for that are not used: they crash on
// indices out of range, join vertices closer than an absolute tolerance, and cut some polygons with
// concave corners into overlapping triangles.
class Collector {
 public:
  Collector(const aiScene& scene, const std::string& path) : scene_(scene), path_(path) {}

  TriangleMesh collect() {
    add_node(*scene_.mRootNode, Eigen::Affine3d::Identity());
    TriangleMesh mesh;
    mesh.vertices = welder_.vertices();
    mesh.triangles.resize(3, triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t) mesh.triangles.col(t) = triangles_[t];
    return mesh;
  }

 private:
  void add_node(const aiNode& node, const Eigen::Affine3d& parent) {
    using RowMajor = Eigen::Matrix<ai_real, 4, 4, Eigen::RowMajor>;
    Eigen::Affine3d pose = parent;
    pose.matrix() *= Eigen::Map<const RowMajor>(&node.mTransformation.a1).cast<double>();
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      add_part(*scene_.mMeshes[node.mMeshes[m]], pose);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add_node(*node.mChildren[c], pose);
  }

  void add_part(const aiMesh& part, const Eigen::Affine3d& pose) {
    const bool mirrored = pose.linear().determinant() < 0.0;
    std::vector<Eigen::Vector3d> corners;
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      corners.clear();
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        if (face.mIndices[k] >= part.mNumVertices) {
          throw InputError(
              fmt::format("mesh '{}': face {} names a vertex that the file lacks", path_, f));
        }
        const aiVector3D& v = part.mVertices[face.mIndices[k]];
        corners.push_back(pose * Eigen::Vector3d(v.x, v.y, v.z));
      }
      if (mirrored) std::reverse(corners.begin(), corners.end());
      add_polygon(corners);
    }
  }

  void add_polygon(const std::vector<Eigen::Vector3d>& corners) {
    for (const auto& [a, b, c] : triangulate_polygon(corners)) {
      if (triangles_.size() == kMaxTriangles) {
        throw InputError(fmt::format("mesh '{}': has more than {} triangles, the most allowed",
                                     path_, kMaxTriangles));
      }
      const int first = welder_.add(corners[a]);
      const int second = welder_.add(corners[b]);
      triangles_.emplace_back(first, second, welder_.add(corners[c]));
    }
  }

  const aiScene& scene_;
  const std::string& path_;
  VertexWelder welder_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace

std::string checked_mesh_extension(const std::string& path) {
  return checked_extension(path, kExtensions);
}

namespace {

TriangleMesh read_by_assimp(const std::string& path) {
  Assimp::Importer importer;
  importer.SetIOHandler(new GuardedIo(path));  // the importer deletes it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw InputError(fmt::format("mesh '{}': cannot be read: {}", path, importer.GetErrorString()));
  }
  TriangleMesh mesh = Collector(*scene, path).collect();
  if (mesh.triangles.cols() > 0) return mesh;
  throw InputError(
      fmt::format("mesh '{}': holds no triangles (points and lines are not a surface)", path));
}

template <class Matrix>
void put_matrix(std::string& bytes, const Matrix& matrix) {
  const Eigen::Index columns = matrix.cols();
  bytes.append(reinterpret_cast<const char*>(&columns), sizeof(columns));
  bytes.append(reinterpret_cast<const char*>(matrix.data()),
               static_cast<std::size_t>(matrix.size()) * sizeof(*matrix.data()));
}

/// Of bytes that put_matrix() made.
template <class Matrix>
const char* take_matrix(const char* bytes, Matrix& matrix) {
  Eigen::Index columns = 0;
  std::memcpy(&columns, bytes, sizeof(columns));
  matrix.resize(3, columns);
  const std::size_t size = static_cast<std::size_t>(matrix.size()) * sizeof(*matrix.data());
  if (size > 0) std::memcpy(matrix.data(), bytes + sizeof(columns), size);
  return bytes + sizeof(columns) + size;
}

}  // namespace

TriangleMesh read_triangle_mesh(const std::string& path) {
  check_content(path, checked_mesh_extension(path));
  // Assimp trusts a file in more ways than are known.
  const std::string bytes = in_child_process({}, fmt::format("mesh '{}'", path), [&] {
    const TriangleMesh mesh = read_by_assimp(path);
    std::string all;
    put_matrix(all, mesh.vertices);
    put_matrix(all, mesh.triangles);
    return all;
  });
  TriangleMesh mesh;
  take_matrix(take_matrix(bytes.data(), mesh.vertices), mesh.triangles);
  return mesh;
}

}  // namespace pliant
