#include "pliant/effects/column_volume.h"

#include <Eigen/Geometry>

namespace pliant {
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
  const Eigen::Vector3d& up = ground.normal;
  // First the sums of height * opposite edge and of areas; their particle's gradient
  //   dV/dx_k = sum_t A_t/3 U + 1/2 h_t U × (x_{k+2} - x_{k+1})
  // follows in one pass over the particles, which are fewer than the triangles' corners.
  gradient.setZero(3, x.cols());
  thread_local Eigen::VectorXd areas;
  // Kept at the size of the largest: bubbles of different sizes take turns.
  if (areas.size() < x.cols()) areas.resize(x.cols());
  areas.head(x.cols()).setZero();
  for (int t = 0; t < triangles.cols(); ++t) {
    const int i = triangles(0, t), j = triangles(1, t), k = triangles(2, t);
    const Eigen::Vector3d xi = x.col(i), xj = x.col(j), xk = x.col(k);
    const double area = up.dot((xj - xi).cross(xk - xi));
    areas[i] += area;
    areas[j] += area;
    areas[k] += area;
    const double height = ground.height(xi) + ground.height(xj) + ground.height(xk);
    if (height == 0.0) continue;
    gradient.col(i) += height * (xk - xj);
    gradient.col(j) += height * (xi - xk);
    gradient.col(k) += height * (xj - xi);
  }
  for (int i = 0; i < x.cols(); ++i) {
    gradient.col(i) = (up.cross(gradient.col(i)) + areas[i] * up) / 6.0;
  }
}

}  // namespace pliant
