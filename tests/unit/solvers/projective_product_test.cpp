// The matrix of projective dynamics without the entries that clusters share: what all entries say.
#include "pliant/solvers/linear/projective_product.h"

#include <gtest/gtest.h>

#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/solvers/iterations/relaxation.h"
#include "support/random.h"
#include "support/solvers/overlapping_clusters.h"
#include "support/solvers/solver_systems.h"

namespace pliant::projective_product_test {
namespace {

constexpr double kStep = 0.004;

/// Overlapping clusters of 20 particles each and one of three, two particles pinned.
ProjectiveSystem cluster_system() {
  Random random(4);
  const int count = 50;
  ProjectiveSystem system = system_at(random.positions(count, 0.1));
  for (int i = 0; i < count; ++i) system.particles.mass[i] = random(0.5, 2.0);
  system.particles.fix(7);
  system.particles.fix(31);
  const std::vector<Cluster> clusters = overlapping_clusters(count, 20, 5, 1e4, 3e5, random);
  system.elements.push_back(std::make_unique<ClusterSet>(
      system.particles.x, Eigen::VectorXd(system.particles.mass), clusters));
  return system;
}

TEST(ProjectiveProduct, OfClustersIsThatOfAllEntries) {
  const ProjectiveSystem system = cluster_system();
  const Eigen::MatrixXd a(projective_matrix(system, kStep));
  ProjectiveProduct product;
  product.assemble(system, kStep);
  EXPECT_TRUE(product.shares());
  EXPECT_LT(product.entries().nonZeros(), 60);
  EXPECT_LE((product.diagonal() - a.diagonal()).norm(), 1e-13 * a.diagonal().norm());
  EXPECT_LE((product.absolute_row_sums() - a.cwiseAbs().rowwise().sum()).norm(),
            1e-13 * a.cwiseAbs().rowwise().sum().norm());
  Random random(9);
  Eigen::VectorXd x(system.particles.size()), y;
  for (double& value : x) value = random(-1.0, 1.0);
  product.multiply(x, y);
  EXPECT_LE((y - a * x).norm(), 1e-13 * a.norm() * x.norm());
}

TEST(ProjectiveProduct, IsAssembledAnew) {
  ProjectiveProduct product;
  product.assemble(cluster_system(), kStep);
  product.assemble(cluster_system(), 2.0 * kStep);
  const Eigen::MatrixXd a(projective_matrix(cluster_system(), 2.0 * kStep));
  EXPECT_LE((product.diagonal() - a.diagonal()).norm(), 1e-13 * a.diagonal().norm());
}

TEST(ProjectiveProduct, RelaxesClustersAsAllEntriesDo) {
  const ProjectiveSystem system = cluster_system();
  ProjectiveProduct product;
  product.assemble(system, kStep);
  const Relaxation by_clusters = make_relaxation(product, system.particles);
  const Relaxation by_entries = make_relaxation(projective_matrix(system, kStep), system.particles);
  EXPECT_NEAR(by_clusters.gamma, by_entries.gamma, 1e-9 * by_entries.gamma);
  EXPECT_LE((by_clusters.mobility - by_entries.mobility).norm(), 1e-9 * by_entries.mobility.norm());
}

class ProjectiveProductOf : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, ProjectiveProductOf, testing::ValuesIn(step_problems()),
                         problem_name);

TEST_P(ProjectiveProductOf, ElementsWithoutClustersHasTheSameBits) {
  const ProjectiveSystem system = GetParam().make();
  ProjectiveProduct product;
  product.assemble(system, kStep);
  if (product.shares()) GTEST_SKIP() << "these are clusters";
  const SparseRows a = projective_matrix(system, kStep);
  EXPECT_TRUE(Eigen::MatrixXd(product.entries()) == Eigen::MatrixXd(a));
  EXPECT_EQ(make_relaxation(product, system.particles).gamma,
            make_relaxation(a, system.particles).gamma);
}

}  // namespace
}  // namespace pliant::projective_product_test
