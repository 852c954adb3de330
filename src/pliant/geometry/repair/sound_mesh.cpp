#include "pliant/geometry/repair/sound_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>

#include "pliant/geometry/distance/winding_count.h"
#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/repair/mesh_cleaning.h"
#include "pliant/geometry/repair/outward.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

constexpr int kLattice = 32;           // points along each side that are asked for their winding
constexpr double kAside = 1e-6;        // of the longest side: how far in front of a triangle
constexpr double kLeastInner = 0.002;  // of the area, what has to be wall within

bool has_sound_numbers(const TriangleMesh& mesh) {
  return mesh.vertices.cols() > 0 && mesh.triangles.cols() > 0 &&
         mesh.triangles.cols() <= kMaxTriangles && mesh.vertices.allFinite() &&
         mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.vertices.cols();
}

void add_count(int count, const std::string& one, const std::string& many,
               std::vector<std::string>& faults) {
  if (count > 0) faults.push_back(fmt::format("{} {}", count, count == 1 ? one : many));
}

int count_turned(const TriangleMesh& before, const TriangleMesh& after) {
  int count = 0;
  for (Eigen::Index t = 0; t < before.triangles.cols(); ++t) {
    count += before.triangles.col(t) != after.triangles.col(t) ? 1 : 0;
  }
  return count;
}

/// Of a closed mesh that turns outward: whether anything is within it twice or less than not at
/// all, or part of its surface has inside on both sides.
bool passes_through_itself(const TriangleMesh& mesh) {
  const WindingCount winding(mesh);
  const Vector3d low = mesh.vertices.rowwise().minCoeff(),
                 size = mesh.vertices.rowwise().maxCoeff() - low;
  for (int k = 0; k < kLattice * kLattice * kLattice; ++k) {
    const int row = k / kLattice, layer = row / kLattice;
    const Eigen::Array3d at(k % kLattice, row % kLattice, layer);
    // Off the middle, where meshes made by rule have their edges.
    const int count = winding(low + ((at + 0.47) / kLattice * size.array()).matrix());
    if (count < 0 || count > 1) return true;
  }
  double area = 0.0, inner = 0.0;
  for (const auto t : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]),
                   c = mesh.vertices.col(t[2]);
    const Vector3d normal = (b - a).cross(c - a);
    area += normal.norm();
    const Vector3d front = (a + b + c) / 3.0 + kAside * size.maxCoeff() * normal.normalized();
    if (winding(front) != 0) inner += normal.norm();
  }
  return inner > kLeastInner * area;
}

}  // namespace

SoundMesh make_sound(const TriangleMesh& mesh) {
  if (!has_sound_numbers(mesh)) {
    throw InputError(fmt::format("{}", fmt::join(mesh_faults(mesh), "; ")));
  }
  SoundMesh sound;
  MeshCleaning done;
  sound.mesh = clean_mesh(mesh, done);
  if (!(area(sound.mesh) > 0.0)) {
    throw InputError("none of its triangles has an area: " +
                     fmt::format("{}", fmt::join(mesh_faults(mesh), "; ")));
  }
  const TriangleMesh before = sound.mesh;
  const int shells = turn_outward(sound.mesh);
  const int turned = count_turned(before, sound.mesh);
  const int open = count_edges(sound.mesh, 1, 1),
            crowded = count_edges(sound.mesh, 3, kMaxTriangles);
  const int opposed = count_opposed(sound.mesh);
  sound.is_manifold = crowded == 0 && opposed == 0;
  sound.closed = sound.is_manifold && open == 0;
  sound.overlaps = sound.closed && passes_through_itself(sound.mesh);
  add_count(done.joined, "vertex joined to another one", "vertices joined to others", sound.faults);
  add_count(done.degenerate, "triangle without area", "triangles without area", sound.faults);
  add_count(done.repeated, "triangle that repeats another one", "triangles that repeat others",
            sound.faults);
  add_count(turned, "triangle turned", "triangles turned", sound.faults);
  add_count(open, "open edge", "open edges", sound.faults);
  add_count(crowded, "edge of more than two triangles", "edges of more than two triangles",
            sound.faults);
  add_count(opposed, "edge whose triangles wind against each other",
            "edges whose triangles wind against each other", sound.faults);
  if (sound.overlaps) {
    sound.faults.push_back(shells == 1 ? "it passes through itself"
                                       : fmt::format("its {} shells overlap or pass through each "
                                                     "other",
                                                     shells));
  }
  const bool is_unchanged = sound.mesh.triangles.cols() == mesh.triangles.cols() &&
                            sound.mesh.vertices.cols() == mesh.vertices.cols() && turned == 0 &&
                            done.joined == 0;
  if (is_unchanged) sound.mesh = mesh;
  return sound;
}

}  // namespace pliant
