#include "pliant/geometry/meshing/simplify.h"

// OpenMesh's vectors start uninitialised by design; the compiler sees that in its templates.
#ifndef __clang__  // which has no such warning
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <fmt/format.h>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <vector>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// Tried in turn until enough edges can go: long thin faces (a cylinder's) begin as slivers.
constexpr double kMostAspectRatios[] = {6.0, 30.0, 1e6};
constexpr double kMostTurn = 45.0;  // of a triangle's normal in one collapse [degrees]

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

Mesh half_edges(const TriangleMesh& mesh, const std::string& where) {
  ::omerr().disable();  // the exception below says it better
  Mesh result;
  std::vector<Mesh::VertexHandle> vertices;
  for (const auto v : mesh.vertices.colwise()) {
    vertices.push_back(result.add_vertex(Mesh::Point(v[0], v[1], v[2])));
  }
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const auto c = mesh.triangles.col(t);
    const auto face = result.add_face(vertices[static_cast<std::size_t>(c[0])],
                                      vertices[static_cast<std::size_t>(c[1])],
                                      vertices[static_cast<std::size_t>(c[2])]);
    if (face.is_valid()) continue;
    throw InputError(
        fmt::format("{}: triangle {} meets others in a vertex without a common edge (the mesh is "
                    "not manifold there): part them",
                    where, t));
  }
  return result;
}

void collapse_edges(Mesh& work, int triangles, double most_aspect_ratio) {
  OpenMesh::Decimater::DecimaterT<Mesh> decimater(work);
  OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  OpenMesh::Decimater::ModAspectRatioT<Mesh>::Handle aspect;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.add(aspect);
  decimater.module(quadric).unset_max_err();  // gives the order
  decimater.module(flipping).set_max_normal_deviation(static_cast<float>(kMostTurn));
  decimater.module(aspect).set_aspect_ratio(static_cast<float>(most_aspect_ratio));
  decimater.module(aspect).set_binary(true);
  decimater.initialize();
  decimater.decimate_to_faces(0, static_cast<std::size_t>(triangles));
  work.garbage_collection();
}

}  // namespace

TriangleMesh simplify(const TriangleMesh& mesh, int triangles, const std::string& where) {
  if (mesh.triangles.cols() <= triangles) return mesh;
  Mesh work = half_edges(mesh, where);
  work.request_face_normals();
  work.update_face_normals();
  for (const double ratio : kMostAspectRatios) {
    if (work.n_faces() > static_cast<std::size_t>(triangles))
      collapse_edges(work, triangles, ratio);
  }

  TriangleMesh result;
  result.vertices.resize(3, static_cast<Eigen::Index>(work.n_vertices()));
  for (const auto v : work.vertices()) {
    const Mesh::Point& p = work.point(v);
    result.vertices.col(v.idx()) << p[0], p[1], p[2];
  }
  result.triangles.resize(3, static_cast<Eigen::Index>(work.n_faces()));
  for (const auto f : work.faces()) {
    int k = 0;
    for (const auto v : work.fv_range(f)) result.triangles(k++, f.idx()) = v.idx();
  }
  return result;
}

}  // namespace pliant
