#pragma once

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "pliant/math/matrix3.h"
#include "support/random.h"

/// Matrices that are easy, hard and impossible to take a rotation from, and what is right for them.
namespace pliant {

/// 10 to a power uniform in [lo, hi).
inline double random_magnitude(Random& random, double lo, double hi) {
  return std::pow(10.0, random(lo, hi));
}

inline Eigen::Matrix3d random_entries(Random& random) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i) = random(-1, 1);
  return m;
}

/// Signed singular values between two random rotations.
inline Eigen::Matrix3d random_frames(Random& random, double s1, double s2, double s3) {
  const Eigen::Matrix3d u = random.rotation();
  return u * Eigen::Vector3d(s1, s2, s3).asDiagonal() * random.rotation().transpose();
}

constexpr int kRotationKinds = 12;

/// `kind` in [0, kRotationKinds); the largest entry about 1.
inline Eigen::Matrix3d unscaled_rotation_case(Random& random, int kind) {
  const auto sign = [&] { return random(-1, 1) < 0 ? -1.0 : 1.0; };
  const double tiny = random_magnitude(random, -17, 0);
  switch (kind) {
    case 0:
      return random_entries(random);
    case 1:  // near identity
      return Eigen::Matrix3d::Identity() + tiny * random_entries(random);
    case 2:  // a stretched and turned body
      return random_frames(random, 1, random(0.3, 1), random(0.3, 1));
    case 3:  // any stretches, inverted or not
      return random_frames(random, 1, tiny, sign() * random_magnitude(random, -17, 0));
    case 4:  // a line with some thickness
      return random_frames(random, 1, tiny, tiny);
    case 5:  // a plane with some thickness
      return random_frames(random, 1, random(0.5, 1), sign() * tiny);
    case 6:  // reflected, the rotation about to be free, or free
      return random_frames(random, 1, 0.5, -0.5 + (random(0, 1) < 0.2 ? 0.0 : tiny));
    case 7:  // reflected, all alike
      return random_frames(random, 1, 1, -1 + (random(0, 1) < 0.2 ? 0.0 : tiny));
    case 8: {  // few different entries: zero, rank one, permutations, reflections, sums that cancel
      const Eigen::Matrix3d m = random_entries(random);
      return (m * random(0.5, 3)).array().round();
    }
    case 9: {  // rows of very different size
      Eigen::Matrix3d m = random_entries(random);
      for (int i = 0; i < 3; ++i) m.row(i) *= random_magnitude(random, -12, 0);
      return m;
    }
    case 10:  // rank one
      return random.vector(1) * random.vector(1).transpose();
    default:  // coincident singular values
      return random_frames(random, 1, 1, sign() * (random(0, 1) < 0.5 ? 1 : tiny));
  }
}

struct RotationCase {
  Eigen::Matrix3d f;
  Eigen::Quaterniond warm_start;
};

/// Case `index` of an endless list; entries over 20 decades.
inline RotationCase rotation_case(Random& random, int index) {
  const double scale = random_magnitude(random, -10, 10);
  const Eigen::Matrix3d f = scale * unscaled_rotation_case(random, index % kRotationKinds);
  return {f, Eigen::Quaterniond(random.rotation())};
}

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

inline ReferenceRotation reference_rotation(const Eigen::Matrix3d& f) {
  ReferenceRotation reference;
  const double size = f.cwiseAbs().maxCoeff();
  reference.f = size > 0 ? Eigen::Matrix3d(f / size) : f;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(reference.f,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  Eigen::Vector3d sigma = (u.transpose() * reference.f * svd.matrixV()).diagonal();
  if ((u * svd.matrixV().transpose()).determinant() < 0) {
    u.col(2) *= -1;
    sigma(2) *= -1;
  }
  reference.rotation = u * svd.matrixV().transpose();
  reference.best = sigma.sum();
  reference.norm = sigma.norm();
  reference.gap = size > 0 ? (sigma(1) + sigma(2)) / reference.norm : 0.0;
  return reference;
}

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
