#include "pliant/study/experiments/carried_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "pliant/math/error.h"
#include "pliant/math/rotation_mean.h"

namespace pliant {

CarriedMesh::CarriedMesh(const TriangleMesh& mesh, const Eigen::Matrix3Xd& carriers)
    : rest_(mesh.vertices), carriers_(carriers) {
  if (carriers.cols() <= kCarriers) {
    throw InputError("a mesh needs nine particles or more that carry it");
  }
  near_.resize(kCarriers, rest_.cols());
  weights_.resize(kCarriers, rest_.cols());
  std::vector<int> order(static_cast<std::size_t>(carriers.cols()));
  for (Eigen::Index v = 0; v < rest_.cols(); ++v) {
    const Eigen::VectorXd squared = (carriers.colwise() - rest_.col(v)).colwise().squaredNorm();
    std::iota(order.begin(), order.end(), 0);
    std::partial_sort(order.begin(), order.begin() + kCarriers + 1, order.end(), [&](int a, int b) {
      return squared[a] < squared[b] || (squared[a] == squared[b] && a < b);
    });
    const double ninth = squared[order[kCarriers]];
    for (int k = 0; k < kCarriers; ++k) {
      near_(k, v) = order[static_cast<std::size_t>(k)];
      const double far = 1.0 - squared[near_(k, v)] / ninth;
      weights_(k, v) = far * far;
    }
    // All at one distance: each counts alike.
    if (weights_.col(v).sum() == 0.0) weights_.col(v).setOnes();
    weights_.col(v) /= weights_.col(v).sum();
  }
}

Eigen::Matrix3Xd CarriedMesh::carry(const Eigen::Matrix3Xd& x, const Eigen::Matrix4Xd& turns,
                                    Blend blend) const {
  Eigen::Matrix3Xd vertices(3, rest_.cols());
  Eigen::Matrix4Xd own(4, kCarriers);
  const int used = blend == Blend::kNearest ? 1 : kCarriers;
  for (Eigen::Index v = 0; v < rest_.cols(); ++v) {
    Eigen::VectorXd weights = weights_.col(v).head(used);
    weights /= weights.sum();
    for (int k = 0; k < used; ++k) own.col(k) = turns.col(near_(k, v));
    const Eigen::Quaterniond turn = blend == Blend::kExponential
                                        ? exponential_rotation_mean(own.leftCols(used), weights)
                                        : linear_rotation_mean(own.leftCols(used), weights);
    vertices.col(v).setZero();
    for (int k = 0; k < used; ++k) {
      const int i = near_(k, v);
      vertices.col(v) += weights[k] * (x.col(i) + turn * (rest_.col(v) - carriers_.col(i)));
    }
  }
  return vertices;
}

double rms_angle_change(const TriangleMesh& rest, const Eigen::Matrix3Xd& vertices) {
  const auto normals = [&](const Eigen::Matrix3Xd& x) {
    Eigen::Matrix3Xd result(3, rest.triangles.cols());
    for (Eigen::Index t = 0; t < result.cols(); ++t) {
      const Eigen::Vector3i corners = rest.triangles.col(t);
      const Eigen::Vector3d side = x.col(corners[1]) - x.col(corners[0]);
      result.col(t) = side.cross(x.col(corners[2]) - x.col(corners[0])).normalized();
    }
    return result;
  };
  const Eigen::Matrix3Xd before = normals(rest.vertices), after = normals(vertices);
  const auto angle = [](const Eigen::Matrix3Xd& n, int a, int b) {
    return std::atan2(n.col(a).cross(n.col(b)).norm(), n.col(a).dot(n.col(b)));
  };
  std::map<std::pair<int, int>, int> first;  // the triangle at each edge that came first
  double sum = 0.0;
  int count = 0;
  for (int t = 0; t < rest.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = rest.triangles(k, t), b = rest.triangles((k + 1) % 3, t);
      const auto [found, added] = first.try_emplace(std::minmax(a, b), t);
      if (added) continue;
      const double change = angle(after, found->second, t) - angle(before, found->second, t);
      sum += change * change;
      ++count;
    }
  }
  return std::sqrt(sum / std::max(1, count)) * 180.0 / M_PI;
}

}  // namespace pliant
