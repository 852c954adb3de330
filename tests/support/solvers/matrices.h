#pragma once

#include <Eigen/Core>

#include "pliant/core/system/element_set.h"

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

Forces forces_of(const ElementSet& set, const Positions& x);

Eigen::MatrixXd system_of(const ElementSet& set, int n);

Eigen::MatrixXd stiffness_of(const ElementSet& set, const Positions& x,
                             Definiteness definiteness = Definiteness::kExact);

/// dF/dx by central differences, 3n x 3n, times -1.
Eigen::MatrixXd stiffness_by_differences(const ElementSet& set, const Positions& x, double h);

double least_eigenvalue(const Eigen::MatrixXd& symmetric);

/// A ⊗ I: a system matrix over coordinates.
Eigen::MatrixXd over_coordinates(const Eigen::MatrixXd& a);

}  // namespace pliant
