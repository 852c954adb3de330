#pragma once

#include <Eigen/Dense>

#include "pliant/core/element_set.h"

namespace pliant {

class DenseMatrix final : public SystemMatrix {
 public:
  explicit DenseMatrix(int n) : matrix(Eigen::MatrixXd::Zero(n, n)) {}
  void add(int row, int column, double stiffness) override { matrix(row, column) += stiffness; }
  Eigen::MatrixXd matrix;
};

/// 3n x 3n, the three coordinates of a particle together.
class DenseStiffness final : public StiffnessMatrix {
 public:
  explicit DenseStiffness(int n) : matrix(Eigen::MatrixXd::Zero(3 * n, 3 * n)) {}
  void add(int row, int column, const Eigen::Matrix3d& block) override {
    matrix.block<3, 3>(3 * row, 3 * column) += block;
  }
  Eigen::MatrixXd matrix;
};

inline Forces forces_of(const ElementSet& set, const Positions& x) {
  Forces f = Forces::Zero(3, x.cols());
  set.add_forces(x, f);
  return f;
}

inline Eigen::MatrixXd system_of(const ElementSet& set, int n) {
  DenseMatrix a(n);
  set.add_to_system(a);
  return a.matrix;
}

inline Eigen::MatrixXd stiffness_of(const ElementSet& set, const Positions& x,
                                    Definiteness definiteness = Definiteness::kExact) {
  DenseStiffness k(static_cast<int>(x.cols()));
  set.add_stiffness(x, definiteness, k);
  return k.matrix;
}

/// dF/dx by central differences, 3n x 3n, times -1.
inline Eigen::MatrixXd stiffness_by_differences(const ElementSet& set, const Positions& x,
                                                double h) {
  Eigen::MatrixXd k(x.size(), x.size());
  for (int c = 0; c < x.size(); ++c) {
    Positions up = x, down = x;
    up.data()[c] += h;
    down.data()[c] -= h;
    const Forces slope = (forces_of(set, down) - forces_of(set, up)) / (2.0 * h);
    k.col(c) = Eigen::Map<const Eigen::VectorXd>(slope.data(), slope.size());
  }
  return k;
}

inline double least_eigenvalue(const Eigen::MatrixXd& symmetric) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly)
      .eigenvalues()[0];
}

/// A ⊗ I: a system matrix over coordinates.
inline Eigen::MatrixXd over_coordinates(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * a.rows(), 3 * a.cols());
  for (int k = 0; k < 3; ++k) {
    for (int r = 0; r < a.rows(); ++r) {
      for (int c = 0; c < a.cols(); ++c) result(3 * r + k, 3 * c + k) = a(r, c);
    }
  }
  return result;
}

}  // namespace pliant
