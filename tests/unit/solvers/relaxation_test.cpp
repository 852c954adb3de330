#include "pliant/solvers/iterations/relaxation.h"

#include <gtest/gtest.h>

#include "pliant/math/symmetric_eigen.h"
#include "support/random.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

/// Eigenvalues of D^-1 A in ascending order, by a dense solver.
Eigen::VectorXd eigenvalues(const SparseRows& a) {
  Eigen::MatrixXd dense(a);
  const Eigen::VectorXd scale = dense.diagonal().cwiseSqrt().cwiseInverse();
  dense = scale.asDiagonal() * dense * scale.asDiagonal();
  return symmetric_eigenvalues(dense);
}

/// Jacobi converges below 2 / lambda_max; 1.8 of it is meant, or the middle of the spectrum where
/// that is less; a margin of 6 % is for the estimate.
void expect_relaxation(const Relaxation& relaxation, double least, double largest) {
  EXPECT_LT(relaxation.gamma * largest, 2.0);
  EXPECT_GT(relaxation.gamma * 1.06, std::min(1.8 / largest, 2.0 / (largest + least)));
}

/// Two triangles over a diagonal of length 1, the rest `height` to either side of it.
TriangleMesh hinge(double height) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0.0, 1.0, 0.5, 0.5, 0.0, 0.0, height, -height, 0.0, 0.0, 0.0, 0.0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 1, 1, 0, 2, 3;
  return mesh;
}

TriangleMesh skewed_grid(double shear, double squeeze) {
  TriangleMesh mesh = make_grid({0.2, 0.2, 9, 9});
  mesh.vertices.row(1) *= squeeze;
  mesh.vertices.row(0) += shear * mesh.vertices.row(1);
  return mesh;
}

std::vector<StepProblem> relaxed_problems() {
  std::vector<StepProblem> problems = step_problems();
  const auto bending = [](const TriangleMesh& mesh, double stiffness) {
    return [mesh, stiffness] { return bending_sheet(mesh, stiffness); };
  };
  problems.push_back({"one_hinge", bending(hinge(0.9), 1.0)});
  problems.push_back({"flat_hinge", bending(hinge(0.01), 1.0)});
  problems.push_back({"slivers", bending(skewed_grid(0.0, 0.01), 1e-3)});
  problems.push_back({"obtuse", bending(skewed_grid(8.0, 0.3), 1e-3)});
  problems.push_back({"stiff_bending", bending(skewed_grid(0.0, 1.0), 1.0)});
  problems.push_back({"free_particles", [] { return system_at(Random(1).positions(10, 1.0)); }});
  return problems;
}

class RelaxationOf : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, RelaxationOf, testing::ValuesIn(relaxed_problems()),
                         problem_name);

TEST_P(RelaxationOf, StaysBelowTheLimitAndCloseToIt) {
  const ProjectiveSystem system = GetParam().make();
  for (const double dt : {1e-4, 0.005, 1.0}) {
    const SparseRows a = projective_matrix(system, dt);
    const Eigen::VectorXd exact = eigenvalues(a);
    const double largest = exact[exact.size() - 1];
    SCOPED_TRACE(dt);
    const Relaxation relaxation = make_relaxation(a, system.particles);
    expect_relaxation(relaxation, exact[0], largest);
    EXPECT_GT(relaxation.largest_eigenvalue, 0.95 * largest);
    EXPECT_LT(relaxation.largest_eigenvalue, 1.06 * largest);
  }
}

TEST_P(RelaxationOf, MobilityIsGammaOverTheDiagonal) {
  const ProjectiveSystem system = GetParam().make();
  const SparseRows a = projective_matrix(system, 0.005);
  const Relaxation relaxation = make_relaxation(a, system.particles);
  for (int i = 0; i < system.particles.size(); ++i) {
    const double expected = system.particles.is_fixed(i) ? 0.0 : relaxation.gamma / a.coeff(i, i);
    EXPECT_NEAR(relaxation.mobility[i], expected, 4e-16 * expected) << i;
  }
}

TEST(Relaxation, AHingeWithoutInertiaGoesToFour) {
  // A single hinge's matrix is w K K^T: D^-1 of it has the eigenvalue 4, sum K_i²/K_i².
  ProjectiveSystem system = bending_sheet(hinge(0.9), 1.0);
  system.particles.release(0);
  const Relaxation relaxation = make_relaxation(projective_matrix(system, 1.0), system.particles);
  EXPECT_NEAR(relaxation.largest_eigenvalue, 4.0, 0.01);
  EXPECT_NEAR(relaxation.gamma, 1.8 / 4.0, 0.002);
}

TEST(Relaxation, InertiaAloneHasTheEigenvalueOne) {
  const ProjectiveSystem system = system_at(Random(1).positions(10, 1.0));
  const Relaxation relaxation = make_relaxation(projective_matrix(system, 0.01), system.particles);
  EXPECT_DOUBLE_EQ(relaxation.largest_eigenvalue, 1.0);
  EXPECT_DOUBLE_EQ(relaxation.gamma, 1.0);
}

TEST(Relaxation, NothingNeedsNone) {
  const ProjectiveSystem system = system_at(Positions::Zero(3, 0));
  EXPECT_EQ(make_relaxation(projective_matrix(system, 0.01), system.particles).mobility.size(), 0);
}

TEST(Relaxation, FindsOneStiffPlaceInALargeSoftBody) {
  // A million particles whose eigenvalue is 1, and a few with up to `stiffest`: a share of 1e-6 of
  // a start without prejudice.
  constexpr int kParticles = 1'000'000;
  for (const double stiffest : {1.3, 2.0, 4.0}) {
    // I + s (K K^T - diag) with K = (1, -1, 1, -1): 1 + 3 s is the largest eigenvalue.
    const double s = (stiffest - 1.0) / 3.0;
    SparseRows a(kParticles, kParticles);
    a.reserve(Eigen::VectorXi::Constant(kParticles, 1));
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < kParticles; ++i) entries.emplace_back(i, i, 1.0);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        if (i != j) entries.emplace_back(i, j, (i + j) % 2 == 0 ? s : -s);
      }
    }
    a.setFromTriplets(entries.begin(), entries.end());
    const Particles particles(Positions::Zero(3, kParticles), Eigen::VectorXd::Ones(kParticles));
    const Relaxation relaxation = make_relaxation(a, particles);
    SCOPED_TRACE(stiffest);
    expect_relaxation(relaxation, 1.0 - s, stiffest);
  }
}

}  // namespace
}  // namespace pliant
