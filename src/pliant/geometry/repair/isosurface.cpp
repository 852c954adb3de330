#include "pliant/geometry/repair/isosurface.h"

#include <algorithm>
#include <unordered_map>
#include <vector>

#include "pliant/geometry/meshing/marching_cubes.h"

namespace pliant {
namespace {

// Of an edge, so far from its ends: a triangle keeps an area where the surface passes a sample.
constexpr double kLeastShare = 1e-3;

class IsosurfaceMaker {
 public:
  explicit IsosurfaceMaker(const DistanceGrid& grid) : grid_(grid) {}

  TriangleMesh make() {
    for (int z = 0; z + 1 < grid_.count[2]; ++z) {
      for (int y = 0; y + 1 < grid_.count[1]; ++y) {
        for (int x = 0; x + 1 < grid_.count[0]; ++x) add_cube({x, y, z});
      }
    }
    TriangleMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices_.size()));
    for (std::size_t v = 0; v < vertices_.size(); ++v) mesh.vertices.col(v) = vertices_[v];
    mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t t = 0; t < triangles_.size(); ++t) mesh.triangles.col(t) = triangles_[t];
    return mesh;
  }

 private:
  std::size_t index(const Eigen::Array3i& at) const {
    return (static_cast<std::size_t>(at[2]) * grid_.count[1] + at[1]) * grid_.count[0] + at[0];
  }
  static Eigen::Array3i corner(int number) {
    return {number & 1, number >> 1 & 1, number >> 2 & 1};
  }

  void add_cube(const Eigen::Array3i& at) {
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      if (grid_.samples[index(at + corner(c))] < 0.0f) inside |= 1 << c;
    }
    if (inside == 0 || inside == 255) return;
    for (const MarchingCubes::Triangle& edges : MarchingCubes::triangles(inside)) {
      Eigen::Vector3i triangle;
      for (int k = 0; k < 3; ++k) {
        triangle[k] = vertex(at + corner(MarchingCubes::edge_corner(edges[k])),
                             MarchingCubes::edge_axis(edges[k]));
      }
      triangles_.push_back(triangle);
    }
  }

  /// On the edge from a sample along an axis.
  int vertex(const Eigen::Array3i& at, int axis) {
    const auto [entry, is_new] =
        vertex_of_.emplace(3 * index(at) + axis, static_cast<int>(vertices_.size()));
    if (is_new) {
      Eigen::Array3i next = at;
      ++next[axis];
      const double a = grid_.samples[index(at)], b = grid_.samples[index(next)];
      const double share = std::clamp(a / (a - b), kLeastShare, 1.0 - kLeastShare);
      Eigen::Vector3d place = at.cast<double>().matrix();
      place[axis] += share;
      vertices_.push_back(grid_.origin + grid_.spacing * place);
    }
    return entry->second;
  }

  const DistanceGrid& grid_;
  std::unordered_map<std::size_t, int> vertex_of_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace

TriangleMesh isosurface(const DistanceGrid& grid) { return IsosurfaceMaker(grid).make(); }

}  // namespace pliant
