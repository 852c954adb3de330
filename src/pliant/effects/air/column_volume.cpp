#include "pliant/effects/air/column_volume.h"

#include <Eigen/Geometry>

namespace pliant {
namespace {

// Sums that run beside each other, so that none waits for the one before.
constexpr int kLanes = 4;

/// Twice the area within the ground.
double area(const double* p, const double* q, const double* r) {
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

double height(const double* p) { return std::max(0.0, p[2]); }

double volume_of(const Eigen::Matrix4Xd& at, const Eigen::Matrix3Xi& triangles) {
  const double* x = at.data();
  const int* t = triangles.data();
  double sums[kLanes] = {};
  const auto add = [&](const int* corners, double& sum) {
    const double *p = x + 4 * corners[0], *q = x + 4 * corners[1], *r = x + 4 * corners[2];
    sum += area(p, q, r) * (height(p) + height(q) + height(r));
  };
  const Eigen::Index count = triangles.cols(), whole = count - count % kLanes;
  for (Eigen::Index k = 0; k < whole; k += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) add(t + 3 * (k + lane), sums[lane]);
  }
  for (Eigen::Index k = whole; k < count; ++k) add(t + 3 * k, sums[0]);
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) / 6.0;
}

/// Room for `count` vertices; more is kept, as bubbles of different sizes take turns.
void reserve(Eigen::Index count, Eigen::Matrix4Xd& numbers) {
  if (numbers.cols() != count) numbers.setZero(4, count);
}

}  // namespace

void heights_above(const Positions& x, const Ground& ground, Eigen::VectorXd& heights) {
  heights.resize(x.cols());
  for (int i = 0; i < x.cols(); ++i) heights[i] = ground.height(x.col(i));
}

void ColumnVolume::place(const Positions& x, const Ground& ground) {
  ground_ = ground;
  along_ = ground.normal.unitOrthogonal();
  across_ = ground.normal.cross(along_);
  reserve(x.cols(), at_);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Eigen::Vector3d p = x.col(i);
    at_.col(i) << along_.dot(p), across_.dot(p), ground.normal.dot(p) - ground.level, 0.0;
  }
}

double ColumnVolume::volume(const Eigen::Matrix3Xi& triangles) const {
  return volume_of(at_, triangles);
}

void ColumnVolume::gradient(const Eigen::Matrix3Xi& triangles, Eigen::Matrix3Xd& gradient) {
  // V = 1/6 sum_t a_t h_t with a_t twice the area and h_t the sum of the heights:
  //   dV/du_k = 1/6 sum_t h_t (v_{k+1} - v_{k+2}),  dV/dv_k = 1/6 sum_t h_t (u_{k+2} - u_{k+1}),
  //   dV/dh_k = 1/6 sum_t a_t.
  reserve(at_.cols(), derivative_);
  derivative_.setZero();
  const double* x = at_.data();
  double* d = derivative_.data();
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const int i = 4 * triangles(0, t), j = 4 * triangles(1, t), k = 4 * triangles(2, t);
    const double *p = x + i, *q = x + j, *r = x + k;
    const double own = area(p, q, r), high = height(p) + height(q) + height(r);
    const auto add = [&](double* at, const double* next, const double* last) {
      at[0] += high * (next[1] - last[1]);
      at[1] += high * (last[0] - next[0]);
      at[2] += own;
    };
    add(d + i, q, r);
    add(d + j, r, p);
    add(d + k, p, q);
  }
  derivative_ /= 6.0;
  gradient.resize(3, at_.cols());
  for (Eigen::Index i = 0; i < at_.cols(); ++i) {
    gradient.col(i) = derivative_(0, i) * along_ + derivative_(1, i) * across_ +
                      derivative_(2, i) * ground_.normal;
  }
}

void ColumnVolume::release(const Eigen::VectorXd& mobility, const Eigen::VectorXd& held) {
  held_ = held;
  reserve(at_.cols(), rates_);
  reserve(at_.cols(), moved_);
  slopes_.resize(at_.cols());
  for (Eigen::Index i = 0; i < at_.cols(); ++i) {
    rates_.col(i) = mobility[i] * derivative_.col(i);
    slopes_[i] = rates_.col(i).dot(derivative_.col(i));
  }
}

double ColumnVolume::volume_after(double delta, const Eigen::Matrix3Xi& triangles, double& slope) {
  moved_ = at_ + delta * rates_;
  // What that takes below the ground counts as on it.
  if (held_.size() > 0) moved_.row(2) -= held_.transpose();
  slope = 0.0;
  for (Eigen::Index i = 0; i < at_.cols(); ++i) slope += moved_(2, i) > 0.0 ? slopes_[i] : 0.0;
  return volume_of(moved_, triangles);
}

double column_volume(const Eigen::Matrix3Xi& triangles, const Positions& x, const Ground& ground) {
  thread_local ColumnVolume column;
  column.place(x, ground);
  return column.volume(triangles);
}

void column_volume_gradient(const Eigen::Matrix3Xi& triangles, const Positions& x,
                            const Ground& ground, Eigen::Matrix3Xd& gradient) {
  thread_local ColumnVolume column;
  column.place(x, ground);
  column.gradient(triangles, gradient);
}

}  // namespace pliant
