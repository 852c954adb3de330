#include "pliant/solvers/linear/cholesky.h"

#include <gtest/gtest.h>

#include "pliant/elements/cloth/spring_set.h"
#include "pliant/math/dense_factors.h"
#include "pliant/math/symmetric_eigen.h"
#include "support/epsilon.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

double condition(const Eigen::MatrixXd& a) {
  const Eigen::VectorXd values = symmetric_eigenvalues(a);
  return values.tail(1)[0] / values[0];
}

class Cholesky : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, Cholesky, testing::ValuesIn(step_problems()), problem_name);

TEST_P(Cholesky, SolvesThreeRightHandSidesAtOnce) {
  const ProjectiveSystem system = GetParam().make();
  const SparseRows a = projective_matrix(system, 0.02);
  const Eigen::MatrixXd dense(a);
  Random random(2);
  const Eigen::Matrix3Xd b = random.positions(static_cast<int>(a.rows()), 1.0);
  const Eigen::Matrix3Xd expected =
      DenseLdlt(dense).solve(Eigen::MatrixXd(b.transpose())).transpose();
  CholeskySolver solver;
  solver.factor(a);
  Eigen::Matrix3Xd x = b;
  solver.solve(x);
  // Both are backward stable: each is off by some n epsilon times the condition number.
  const double bound = 4.0 * static_cast<double>(a.rows()) * kEpsilon * condition(dense);
  EXPECT_LE((x - expected).norm(), bound * expected.norm());
  // And the equation itself holds without the condition number.
  EXPECT_LE((x * dense - b).norm(),
            4.0 * static_cast<double>(a.rows()) * kEpsilon * dense.norm() * x.norm());
}

TEST_P(Cholesky, IsSymmetric) {
  const ProjectiveSystem system = GetParam().make();
  const SparseRows a = projective_matrix(system, 0.02);
  CholeskySolver solver;
  solver.factor(a);
  Random random(4);
  const Eigen::Matrix3Xd b = random.positions(static_cast<int>(a.rows()), 1.0);
  const Eigen::Matrix3Xd c = random.positions(static_cast<int>(a.rows()), 1.0);
  Eigen::Matrix3Xd x = b, y = c;
  solver.solve(x);
  solver.solve(y);
  const double bound =
      static_cast<double>(a.rows()) * kEpsilon * condition(Eigen::MatrixXd(a)) * x.norm();
  EXPECT_NEAR(x.cwiseProduct(c).sum(), y.cwiseProduct(b).sum(), bound * c.norm());
}

SparseRows sparse(const Eigen::MatrixXd& dense) { return SparseRows(dense.sparseView()); }

TEST(CholeskySolver, TakesAnotherMatrixOfAnotherSize) {
  CholeskySolver solver;
  solver.factor(sparse(Eigen::Matrix3d::Identity()));
  EXPECT_EQ(solver.nonzeros(), 3);
  Eigen::Matrix2d a;
  a << 4.0, 1.0, 1.0, 3.0;
  solver.factor(sparse(a));
  Eigen::Matrix3Xd x(3, 2);
  x << 1.0, 2.0, 5.0, 4.0, -9.0, -5.0;
  solver.solve(x);
  Eigen::Matrix3Xd expected(3, 2);
  expected << 1.0 / 11.0, 7.0 / 11.0, 1.0, 1.0, -2.0, -1.0;
  EXPECT_LE((x - expected).cwiseAbs().maxCoeff(), 8 * kEpsilon);
}

TEST(CholeskySolver, TakesColumnsTogetherInAnyNumber) {
  // Full blocks of 1 to 9 rows, one after the other, the last row of each tied to that of the next:
  // as many columns have the same rows below them, and panels of four are followed by less.
  Random random(21);
  const int blocks = 9, size = blocks * (blocks + 1) / 2;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
  for (int b = 1, first = 0; b <= blocks; first += b, ++b) {
    for (int i = 0; i < b; ++i) {
      for (int j = 0; j <= i; ++j) {
        a(first + i, first + j) = a(first + j, first + i) = random(-1.0, 1.0);
      }
      a(first + i, first + i) = 12.0;
    }
    const int last = first + b - 1;
    if (b < blocks) a(last, last + b + 1) = a(last + b + 1, last) = 0.5;
  }
  const Eigen::Matrix3Xd b = random.positions(size, 1.0);
  CholeskySolver solver;
  solver.factor(sparse(a));
  Eigen::Matrix3Xd x = b;
  solver.solve(x);
  EXPECT_LE((x * a - b).norm(), 4.0 * size * kEpsilon * a.norm() * x.norm());
}

TEST(CholeskySolver, RefusesWhatIsNotPositiveDefinite) {
  CholeskySolver solver;
  Eigen::Matrix2d indefinite, singular;
  indefinite << 1.0, 2.0, 2.0, 1.0;
  singular << 1.0, -1.0, -1.0, 1.0;
  for (const Eigen::Matrix2d& a : {indefinite, singular}) {
    expect_refusal([&] { solver.factor(sparse(a)); }, {"positive definite", "time step", "xpbd"});
  }
}

TEST(CholeskySolver, NothingIsSolvedByNothing) {
  CholeskySolver solver;
  solver.factor(SparseRows(0, 0));
  Eigen::Matrix3Xd x(3, 0);
  solver.solve(x);
  EXPECT_EQ(x.cols(), 0);
}

TEST(CholeskySolver, OrdersForLittleFill) {
  // In the order of its rows a net of 31 x 31 fills its band, 31 entries a column.
  ProjectiveSystem system = system_at(make_grid({1, 1, 31, 31}).vertices);
  system.elements.push_back(std::make_unique<SpringSet>(
      "stretch",
      [] {
        std::vector<Spring> springs;
        for (int i = 0; i < 961; ++i) {
          if (i % 31 != 30) springs.push_back({i, i + 1, 0.1, 1.0});
          if (i + 31 < 961) springs.push_back({i, i + 31, 0.1, 1.0});
        }
        return springs;
      }(),
      961));
  CholeskySolver solver;
  solver.factor(projective_matrix(system, 0.01));
  EXPECT_LT(solver.nonzeros(), 31 * 961 / 2);
}

}  // namespace
}  // namespace pliant
