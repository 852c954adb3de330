#pragma once

#include <Eigen/Geometry>

#include "pliant/math/rotation.h"

/// nearest_rotation (rotation.h) for Eigen's 3x3 matrices and expressions, float or double.
namespace pliant {

template <typename Derived>
Matrix3<typename Derived::Scalar> to_plain(const Eigen::MatrixBase<Derived>& f) {
  EIGEN_STATIC_ASSERT_MATRIX_SPECIFIC_SIZE(Derived, 3, 3)
  const auto& g = f.derived().eval();
  return {{g(0, 0), g(0, 1), g(0, 2), g(1, 0), g(1, 1), g(1, 2), g(2, 0), g(2, 1), g(2, 2)}};
}

template <typename T>
Quaternion<T> to_plain(const Eigen::Quaternion<T>& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

template <typename T>
Eigen::Matrix<T, 3, 3> to_eigen(const Matrix3<T>& a) {
  Eigen::Matrix<T, 3, 3> result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) result(i, j) = a(i, j);
  }
  return result;
}

template <typename T>
Eigen::Quaternion<T> to_eigen(const Quaternion<T>& q) {
  return {q.w, q.x, q.y, q.z};
}

template <typename Derived>
Eigen::Quaternion<typename Derived::Scalar> nearest_rotation(
    const Eigen::MatrixBase<Derived>& f,
    const Eigen::Quaternion<typename Derived::Scalar>& warm_start) {
  return to_eigen(nearest_rotation(to_plain(f), to_plain(warm_start)));
}

template <typename Derived>
Eigen::Quaternion<typename Derived::Scalar> nearest_rotation(const Eigen::MatrixBase<Derived>& f) {
  return to_eigen(nearest_rotation(to_plain(f)));
}

}  // namespace pliant
