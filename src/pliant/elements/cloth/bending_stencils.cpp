#include "pliant/elements/cloth/bending_stencils.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pliant/elements/cloth/edge_slopes.h"
#include "pliant/elements/cloth/warp_direction.h"

namespace pliant {
namespace {

// Of the largest weight, below which one is round-off; and of a curvature's weight times the area,
// where a triangle feels no bending at all.
constexpr double kRoundOff = 1e-13, kFlat = 1e-9;

/// The curvature of one triangle times its area, of its vertices and those around it: along warp,
/// along weft, and twist.
class TriangleCurvature {
 public:
  /// What a value at `vertex` adds, by its weight in the gradient at an edge; both in warp and
  /// weft, the normal as long as the edge.
  void add(int vertex, const Eigen::Vector2d& normal, const Eigen::Vector2d& gradient) {
    const auto at = std::find(vertices_.begin(), vertices_.end(), vertex);
    const auto k = static_cast<std::size_t>(at - vertices_.begin());
    if (at == vertices_.end()) {
      vertices_.push_back(vertex);
      weights_.push_back(Eigen::Vector3d::Zero());
    }
    weights_[k] += Eigen::Vector3d(normal[0] * gradient[0], normal[1] * gradient[1],
                                   0.5 * (normal[0] * gradient[1] + normal[1] * gradient[0]));
  }

  /// Of triangle `corners`; nothing where no vertex bends it.
  void append(const Eigen::Vector3i& corners, double area, const Eigen::Vector3d& stiffness,
              BendingStencils& stencils) const {
    double largest = 0.0;
    for (const auto& weight : weights_) {
      largest = std::max(largest, weight.cwiseAbs().maxCoeff());
    }
    if (largest <= kFlat) return;
    const Eigen::Vector3d roots = (stiffness / area).cwiseSqrt();
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
      if (weights_[k].cwiseAbs().maxCoeff() <= kRoundOff * largest) continue;
      stencils.vertices.push_back(vertices_[k]);
      const Eigen::Vector3d weight = roots.cwiseProduct(weights_[k]);
      stencils.weights.insert(stencils.weights.end(), weight.data(), weight.data() + 3);
    }
    stencils.firsts.push_back(static_cast<int>(stencils.vertices.size()));
    stencils.triangles.push_back({corners[0], corners[1], corners[2]});
  }

 private:
  std::vector<int> vertices_;
  std::vector<Eigen::Vector3d> weights_;
};

}  // namespace

BendingStencils bending_of_mesh(const TriangleMesh& rest, const Eigen::Vector3d& warp,
                                const BendingStiffness& stiffness) {
  const MeshSides sides = find_sides(rest);
  const std::vector<EdgeSlope> slopes = edge_slopes(rest, sides);
  const Eigen::Vector3d each(stiffness.warp, stiffness.weft,
                             2.0 * std::sqrt(stiffness.warp * stiffness.weft));
  const Eigen::Vector3d direction = warp.normalized();
  BendingStencils stencils;
  stencils.rows = 3;
  for (int t = 0; t < rest.triangles.cols(); ++t) {
    const Eigen::Vector3i v = rest.triangles.col(t);
    const Eigen::Vector3d twice_area =
        (rest.vertices.col(v[1]) - rest.vertices.col(v[0]))
            .cross(rest.vertices.col(v[2]) - rest.vertices.col(v[0]));
    const Eigen::Vector3d up = twice_area.normalized(), along = warp_within(direction, up);
    Eigen::Matrix<double, 2, 3> axes;
    axes << along.transpose(), up.cross(along).transpose();
    TriangleCurvature curvature;
    for (int k = 0; k < 3; ++k) {
      const int from = v[(k + 1) % 3], to = v[(k + 2) % 3];
      const Eigen::Vector2d side = axes * (rest.vertices.col(to) - rest.vertices.col(from));
      const Eigen::Vector2d normal(side.y(), -side.x());  // outward, as long as the side
      const Eigen::Vector2d tangent = side / side.squaredNorm(), out = normal.normalized();
      curvature.add(to, normal, tangent);
      curvature.add(from, normal, -tangent);
      const auto edge = static_cast<std::size_t>(
          sides.opposite[static_cast<std::size_t>(t)][static_cast<std::size_t>(k)]);
      const double sign = sides.triangles[edge][0] == t ? 1.0 : -1.0;
      const EdgeSlope& slope = slopes[edge];
      for (std::size_t n = 0; n < slope.vertices.size(); ++n) {
        curvature.add(slope.vertices[n], normal, sign * slope.weights[n] * out);
      }
    }
    curvature.append(v, 0.5 * twice_area.norm(), each, stencils);
  }
  return stencils;
}

}  // namespace pliant
