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

double volume_of(const Eigen::Matrix4Xd& at, const CoverTriangles& triangles) {
  const double* x = at.data();
  const int* t = triangles.corners.data();
  const double* share = triangles.shares.data();
  double sums[kLanes] = {};
  const auto add = [&](Eigen::Index k, double& sum) {
    const int* corners = t + 3 * k;
    const double* s = share + 3 * k;
    const double *p = x + 4 * corners[0], *q = x + 4 * corners[1], *r = x + 4 * corners[2];
    sum += area(p, q, r) * (s[0] * height(p) + s[1] * height(q) + s[2] * height(r));
  };
  const Eigen::Index count = triangles.size(), whole = count - count % kLanes;
  for (Eigen::Index k = 0; k < whole; k += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) add(k + lane, sums[lane]);
  }
  for (Eigen::Index k = whole; k < count; ++k) add(k, sums[0]);
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) / 2.0;
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

double ColumnVolume::volume(const CoverTriangles& triangles) const {
  return volume_of(at_, triangles);
}

void ColumnVolume::gradient(const CoverTriangles& triangles, Eigen::Matrix3Xd& gradient) {
  // V = 1/2 sum_t a_t h_t with a_t twice the area and h_t the mean height, by the shares s_k:
  //   dV/du_k = 1/2 sum_t h_t (v_{k+1} - v_{k+2}),  dV/dv_k = 1/2 sum_t h_t (u_{k+2} - u_{k+1}),
  //   dV/dh_k = 1/2 sum_t s_k a_t.
  reserve(at_.cols(), derivative_);
  derivative_.setZero();
  const double* x = at_.data();
  double* d = derivative_.data();
  for (Eigen::Index t = 0; t < triangles.size(); ++t) {
    const Eigen::Vector3i at = 4 * triangles.corners.col(t);
    const Eigen::Vector3d share = triangles.shares.col(t);
    const double *p = x + at[0], *q = x + at[1], *r = x + at[2];
    const double own = area(p, q, r);
    const double high = share[0] * height(p) + share[1] * height(q) + share[2] * height(r);
    const auto add = [&](int k, const double* next, const double* last) {
      double* to = d + at[k];
      to[0] += high * (next[1] - last[1]);
      to[1] += high * (last[0] - next[0]);
      to[2] += share[k] * own;
    };
    add(0, q, r);
    add(1, r, p);
    add(2, p, q);
  }
  derivative_ /= 2.0;
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

double ColumnVolume::volume_after(double delta, const CoverTriangles& triangles, double& slope) {
  moved_ = at_ + delta * rates_;
  // What that takes below the ground counts as on it.
  if (held_.size() > 0) moved_.row(2) -= held_.transpose();
  slope = 0.0;
  for (Eigen::Index i = 0; i < at_.cols(); ++i) slope += moved_(2, i) > 0.0 ? slopes_[i] : 0.0;
  return volume_of(moved_, triangles);
}

double column_volume(const CoverTriangles& triangles, const Positions& x, const Ground& ground) {
  thread_local ColumnVolume column;
  column.place(x, ground);
  return column.volume(triangles);
}

void column_volume_gradient(const CoverTriangles& triangles, const Positions& x,
                            const Ground& ground, Eigen::Matrix3Xd& gradient) {
  thread_local ColumnVolume column;
  column.place(x, ground);
  column.gradient(triangles, gradient);
}

}  // namespace pliant
