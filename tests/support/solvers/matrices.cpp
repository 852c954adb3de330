#include "support/solvers/matrices.h"

#include "pliant/math/symmetric_eigen.h"

namespace pliant {

Forces forces_of(const ElementSet& set, const Positions& x) {
  Forces f = Forces::Zero(3, x.cols());
  set.add_forces(x, f);
  return f;
}

Eigen::MatrixXd system_of(const ElementSet& set, int n) {
  DenseMatrix a(n);
  set.add_to_system(a);
  return a.matrix;
}

Eigen::MatrixXd stiffness_of(const ElementSet& set, const Positions& x, Definiteness definiteness) {
  DenseStiffness k(static_cast<int>(x.cols()));
  set.add_stiffness(x, definiteness, k);
  return k.matrix;
}

Eigen::MatrixXd stiffness_by_differences(const ElementSet& set, const Positions& x, double h) {
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

Eigen::MatrixXd over_coordinates(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(3 * a.rows(), 3 * a.cols());
  for (int k = 0; k < 3; ++k) {
    for (int r = 0; r < a.rows(); ++r) {
      for (int c = 0; c < a.cols(); ++c) result(3 * r + k, 3 * c + k) = a(r, c);
    }
  }
  return result;
}

double least_eigenvalue(const Eigen::MatrixXd& symmetric) {
  return symmetric_eigenvalues(symmetric)[0];
}

}  // namespace pliant
