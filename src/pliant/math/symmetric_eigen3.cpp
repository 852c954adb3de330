#include "pliant/math/symmetric_eigen3.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Below this share of half of the diagonal's difference, series of the angle are exact to
// round-off.
constexpr double kSmall = 1e-6;

/// Makes the length of `v` 1 to round-off, by a step of Newton's method: it is to 1e-8 already.
void normalise(Eigen::Ref<Eigen::Vector3d> v) { v *= 1.5 - 0.5 * v.squaredNorm(); }

/// A rotation of Jacobi: makes b(i, j) zero, and keeps b = vᵀ a v.
void rotate(int i, int j, Eigen::Matrix3d& b, Eigen::Matrix3d& v) {
  const double off = b(i, j);
  if (off == 0.0) return;
  const double half = 0.5 * (b(j, j) - b(i, i));
  double tangent, cosine;
  if (std::abs(off) < kSmall * std::abs(half)) {
    // The same to round-off, without roots.
    tangent = 0.5 * off / half;
    cosine = 1.0 - 0.5 * tangent * tangent;
  } else {
    tangent = off / (half + std::copysign(std::sqrt(half * half + off * off), half));
    cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
  }
  const double sine = tangent * cosine;
  const int k = 3 - i - j;
  const double ki = b(k, i), kj = b(k, j);
  b(i, i) -= tangent * off;
  b(j, j) += tangent * off;
  b(i, j) = b(j, i) = 0.0;
  b(k, i) = b(i, k) = cosine * ki - sine * kj;
  b(k, j) = b(j, k) = sine * ki + cosine * kj;
  const Eigen::Vector3d vi = v.col(i), vj = v.col(j);
  v.col(i) = cosine * vi - sine * vj;
  v.col(j) = sine * vi + cosine * vj;
}

}  // namespace

SymmetricEigen3 symmetric_eigen3(const Eigen::Matrix3d& a) {
  const Eigen::Matrix3d whole = a.selfadjointView<Eigen::Lower>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> direct;
  direct.computeDirect(whole);
  Eigen::Matrix3d v = direct.eigenvectors();
  normalise(v.col(0));
  v.col(2) -= v.col(0).dot(v.col(2)) * v.col(0);
  normalise(v.col(2));
  v.col(1) = v.col(2).cross(v.col(0));
  Eigen::Matrix3d b = v.transpose() * whole * v;
  rotate(0, 1, b, v);
  rotate(0, 2, b, v);
  rotate(1, 2, b, v);
  SymmetricEigen3 result{b.diagonal(), v};
  const auto order = [&](int i, int j) {
    if (result.values[i] <= result.values[j]) return;
    std::swap(result.values[i], result.values[j]);
    result.vectors.col(i).swap(result.vectors.col(j));
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return result;
}

}  // namespace pliant
