#pragma once

#include <Eigen/Core>

namespace pliant {

/// The columns of both, those of `left` first.
template <class Matrix>
Matrix beside(const Matrix& left, const Matrix& right) {
  Matrix both(left.rows(), left.cols() + right.cols());
  both << left, right;
  return both;
}

/// The numbers of both, those of `top` first.
inline Eigen::VectorXd above(const Eigen::VectorXd& top, const Eigen::VectorXd& bottom) {
  Eigen::VectorXd both(top.size() + bottom.size());
  both << top, bottom;
  return both;
}

}  // namespace pliant
