#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "pliant/math/rotation.h"
#include "support/random.h"

/// Matrices that are easy, hard and impossible to take a rotation from, and what is right for them.
namespace pliant {

/// 10 to a power uniform in [lo, hi).
inline double random_magnitude(Random& random, double lo, double hi) {
  return std::pow(10.0, random(lo, hi));
}

Eigen::Matrix3d random_entries(Random& random);

/// Signed singular values between two random rotations.
inline Eigen::Matrix3d random_frames(Random& random, double s1, double s2, double s3) {
  const Eigen::Matrix3d u = random.rotation();
  return u * Eigen::Vector3d(s1, s2, s3).asDiagonal() * random.rotation().transpose();
}

constexpr int kRotationKinds = 12;

/// `kind` in [0, kRotationKinds); the largest entry about 1.
Eigen::Matrix3d unscaled_rotation_case(Random& random, int kind);

struct RotationCase {
  Eigen::Matrix3d f;
  Eigen::Quaterniond warm_start;
};

/// Case `index` of an endless list; entries over 20 decades.
RotationCase rotation_case(Random& random, int index);

/// Rounded to T.
template <typename T>
Matrix3<T> plain_matrix(const Eigen::Matrix3d& f) {
  Matrix3<T> m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m(i, j) = static_cast<T>(f(i, j));
  }
  return m;
}

template <typename T>
Quaternion<T> plain_quaternion(const Eigen::Quaterniond& q) {
  return {static_cast<T>(q.w()), static_cast<T>(q.x()), static_cast<T>(q.y()),
          static_cast<T>(q.z())};
}

template <typename T>
Eigen::Matrix3d wide(const Matrix3<T>& m) {
  Eigen::Matrix3d f;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) f(i, j) = static_cast<double>(m(i, j));
  }
  return f;
}

template <typename T>
Eigen::Quaterniond wide(const Quaternion<T>& q) {
  return Eigen::Quaterniond(static_cast<double>(q.w), static_cast<double>(q.x),
                            static_cast<double>(q.y), static_cast<double>(q.z));
}

/// By singular value decomposition in double, for the matrix divided by its largest entry.
struct ReferenceRotation {
  Eigen::Matrix3d f;         ///< scaled
  Eigen::Matrix3d rotation;  ///< U diag(1, 1, ±1) Vᵀ
  double best = 0.0;         ///< tr(RᵀF), the largest possible
  double gap = 0.0;          ///< (σ₂ + σ₃) / |F|, σ₃ with the sign of det F
  double norm = 0.0;         ///< |F|
};

ReferenceRotation reference_rotation(const Eigen::Matrix3d& f);

/// How far a computed rotation is from right, in units of T's ε.
struct RotationError {
  bool finite = false;
  double length = 0.0;   ///< |q| - 1
  double deficit = 0.0;  ///< (largest possible tr(RᵀF) - tr(RᵀF)) / |F|
  double angle = 0.0;    ///< to the reference, times the gap: round-off in F alone gives about 1
};

template <typename T>
RotationError rotation_error(const ReferenceRotation& reference, const Quaternion<T>& q) {
  const double epsilon = std::is_same_v<T, float> ? 0x1p-23 : 0x1p-52;
  const Eigen::Quaterniond p = wide(q);
  RotationError error;
  error.finite = p.coeffs().allFinite();
  if (!error.finite) return error;
  error.length = std::abs(p.norm() - 1.0) / epsilon;
  const Eigen::Matrix3d r = p.normalized().toRotationMatrix();
  if (reference.norm > 0) {
    const double reached = (r.transpose() * reference.f).trace();
    error.deficit = (reference.best - reached) / reference.norm / epsilon;
  }
  // |R - S| = 2√2 sin(θ/2)
  const double half_sine = std::min(1.0, (r - reference.rotation).norm() / std::sqrt(8.0));
  error.angle = 2.0 * std::asin(half_sine) * reference.gap / epsilon;
  return error;
}

}  // namespace pliant
