#include "pliant/solvers/linear/projective_matrix.h"

#include <gtest/gtest.h>

#include "support/epsilon.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

class ProjectiveMatrix : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, ProjectiveMatrix, testing::ValuesIn(step_problems()),
                         problem_name);

TEST_P(ProjectiveMatrix, IsTheSumOfInertiaAndElements) {
  const ProjectiveSystem system = GetParam().make();
  for (const double dt : {1e-4, 0.005, 1.0}) {
    const Eigen::MatrixXd expected = dense_matrix(system, dt);
    const Eigen::MatrixXd a(projective_matrix(system, dt));
    // Sums of some fifty entries in another order.
    EXPECT_LE((a - expected).cwiseAbs().maxCoeff(), 50 * kEpsilon * expected.cwiseAbs().maxCoeff());
  }
}

TEST_P(ProjectiveMatrix, RowsAndColumnsOfFixedParticlesAreTheIdentitys) {
  const ProjectiveSystem system = GetParam().make();
  const Eigen::MatrixXd a(projective_matrix(system, 0.005));
  int fixed = 0;
  for (int i = 0; i < system.particles.size(); ++i) {
    if (!system.particles.is_fixed(i)) continue;
    ++fixed;
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(a.rows(), i);
    EXPECT_EQ(a.row(i).transpose(), unit);
    EXPECT_EQ(a.col(i), unit);
  }
  EXPECT_GT(fixed, 0);
}

TEST_P(ProjectiveMatrix, IsSymmetricAndPositiveDefinite) {
  const ProjectiveSystem system = GetParam().make();
  const double dt = 0.005;
  const Eigen::MatrixXd a(projective_matrix(system, dt));
  EXPECT_LE((a - a.transpose()).cwiseAbs().maxCoeff(), 50 * kEpsilon * a.cwiseAbs().maxCoeff());
  // No eigenvalue is below the smallest inertia, or the 1 of a fixed particle.
  const double least = std::min(1.0, system.particles.mass.minCoeff() / (dt * dt));
  EXPECT_GE(least_eigenvalue(a), least - a.rows() * kEpsilon * a.norm());
}

TEST_P(ProjectiveMatrix, MultipliesEachCoordinate) {
  const ProjectiveSystem system = GetParam().make();
  const SparseRows a = projective_matrix(system, 0.005);
  Random random(5);
  const Positions x = random.positions(system.particles.size(), 1.0);
  Positions y;
  multiply(a, x, y);
  const Positions expected = x * Eigen::MatrixXd(a);
  EXPECT_LE((y - expected).cwiseAbs().maxCoeff(), 50 * kEpsilon * a.norm() * x.norm());
}

TEST_P(ProjectiveMatrix, BoundsTheStiffnessFromAbove) {
  // What makes a projective step safe: A - d²φ/dx² is positive semi-definite wherever it stands.
  const ProjectiveSystem system = GetParam().make();
  const int n = system.particles.size();
  DenseMatrix a(n);
  DenseStiffness k(n);
  for (const auto& set : system.elements) {
    set->add_to_system(a);
    set->add_stiffness(system.particles.x, Definiteness::kExact, k);
  }
  const Eigen::MatrixXd difference = over_coordinates(a.matrix) - k.matrix;
  EXPECT_GE(least_eigenvalue(0.5 * (difference + difference.transpose())),
            -3 * n * kEpsilon * a.matrix.norm());
}

TEST(FreeMobility, IsTheInverseAndZeroForFixedParticles) {
  Particles particles(Positions::Zero(3, 3), Eigen::VectorXd::Ones(3));
  particles.fix(1);
  const Eigen::VectorXd mobility = free_mobility(Eigen::Vector3d(2.0, 4.0, 0.5), particles);
  EXPECT_EQ(mobility, Eigen::Vector3d(0.5, 0.0, 2.0));
}

TEST(ProjectiveMatrixOfNothing, HasNoRows) {
  ProjectiveSystem system = system_at(Positions::Zero(3, 0));
  EXPECT_EQ(projective_matrix(system, 0.01).rows(), 0);
}

}  // namespace
}  // namespace pliant
