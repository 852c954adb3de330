#include "pliant/effects/column_volume.h"

#include <Eigen/Geometry>

namespace pliant {
namespace {

struct Column {
  double area;    // signed, projected to the ground
  double height;  // mean of the corners'
};

Column column(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
              const Ground& ground) {
  return {0.5 * ground.normal.dot((b - a).cross(c - a)),
          (ground.height(a) + ground.height(b) + ground.height(c)) / 3.0};
}

}  // namespace

void heights_above(const Positions& x, const Ground& ground, Eigen::VectorXd& heights) {
  heights.resize(x.cols());
  for (int i = 0; i < x.cols(); ++i) heights[i] = ground.height(x.col(i));
}

double column_volume(const Eigen::Matrix3Xi& triangles, const Positions& x,
                     const Eigen::VectorXd& heights, const Eigen::Vector3d& up) {
  double sum = 0.0;
  for (int t = 0; t < triangles.cols(); ++t) {
    const int i = triangles(0, t), j = triangles(1, t), k = triangles(2, t);
    const double height = heights[i] + heights[j] + heights[k];
    if (height == 0.0) continue;
    sum += up.dot((x.col(j) - x.col(i)).cross(x.col(k) - x.col(i))) * height;
  }
  return sum / 6.0;
}

double column_volume(const Eigen::Matrix3Xi& triangles, const Positions& x, const Ground& ground) {
  Eigen::VectorXd heights;
  heights_above(x, ground, heights);
  return column_volume(triangles, x, heights, ground.normal);
}

void column_volume_gradient(const Eigen::Matrix3Xi& triangles, const Positions& x,
                            const Ground& ground, Eigen::Matrix3Xd& gradient) {
  gradient.setZero(3, x.cols());
  for (int t = 0; t < triangles.cols(); ++t) {
    const int v[3] = {triangles(0, t), triangles(1, t), triangles(2, t)};
    const Column part = column(x.col(v[0]), x.col(v[1]), x.col(v[2]), ground);
    for (int k = 0; k < 3; ++k) {
      // d area / d x_k = 1/2 U × (x_{k+2} - x_{k+1})
      const Eigen::Vector3d opposite = x.col(v[(k + 2) % 3]) - x.col(v[(k + 1) % 3]);
      gradient.col(v[k]) += part.area / 3.0 * ground.normal +
                            0.5 * part.height * ground.normal.cross(opposite);
    }
  }
}

}  // namespace pliant
