// Coarser and coarser matrices, and the V-cycle that stands for the inverse of projective dynamics.
#include "pliant/solvers/linear/multigrid.h"

#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "pliant/elements/cloth/bending_set.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

constexpr double kTimeStep = 0.005;

/// A of a cloth of 1 m, as stiff along the warp as fabrics are.
SparseRows cloth_matrix(int side, double weft = 500.0, double shear = 50.0) {
  const GridOptions grid{1.0, 1.0, side, side};
  const TriangleMesh mesh = make_grid(grid);
  std::vector<Spring> springs = grid_stretch_springs(grid, {500.0, weft, 0.0});
  const std::vector<Spring> diagonals = grid_shear_springs(grid, shear, 2);
  springs.insert(springs.end(), diagonals.begin(), diagonals.end());
  ProjectiveSystem system;
  system.particles = Particles(mesh.vertices, 0.15 * vertex_areas(mesh));
  system.elements.push_back(
      std::make_unique<SpringSet>("stretch", springs, system.particles.size()));
  system.elements.push_back(std::make_unique<BendingSet>(grid, 1e-5, 1e-5));
  return projective_matrix(system, kTimeStep);
}

/// How much of an error in the norm of A a cycle leaves, in the long run.
double rate_of(const SparseRows& a, const Multigrid& multigrid, int cycles) {
  Positions error = Random(3).positions(static_cast<int>(a.rows()), 1.0), product;
  double before = 0.0, rate = 0.0;
  for (int k = 0; k <= cycles; ++k) {
    multiply(a, error, product);
    const double size = std::sqrt(error.cwiseProduct(product).sum());
    rate = size / before;
    before = size;
    multigrid.solve(product);
    error -= product;
  }
  return rate;
}

TEST(Multigrid, ItsRateHardlyDependsOnTheMesh) {
  for (int side : {30, 60, 120}) {
    const SparseRows a = cloth_matrix(side);
    const Multigrid multigrid(a);
    EXPECT_LT(rate_of(a, multigrid, 15), 0.55) << side;
    EXPECT_LT(multigrid.complexity(), 1.3) << side;
    EXPECT_TRUE(multigrid.levels().back().is_coarsest);
  }
}

TEST(Multigrid, WarpTenTimesAsStiffAsWeft) {
  const SparseRows a = cloth_matrix(60, 50.0, 5.0);
  EXPECT_LT(rate_of(a, Multigrid(a), 15), 0.75);
}

TEST(Multigrid, OfTetrahedraAndOfRandomNets) {
  for (const StepProblem& problem : step_problems()) {
    const ProjectiveSystem system = problem.make();
    const SparseRows a = projective_matrix(system, problem.dt);
    EXPECT_LT(rate_of(a, Multigrid(a), 15), 0.75) << problem.name;
  }
}

TEST(Multigrid, IsSymmetricAndPositiveDefinite) {
  const SparseRows a = cloth_matrix(14);
  const Multigrid multigrid(a);
  ASSERT_GE(multigrid.levels().size(), 2u);
  const auto n = static_cast<int>(a.rows());
  Eigen::MatrixXd b(n, n);
  for (int i = 0; i < n; ++i) {
    Eigen::Matrix3Xd v = Eigen::Matrix3Xd::Zero(3, n);
    v(1, i) = 1.0;
    multigrid.solve(v);
    b.col(i) = v.row(1);
  }
  EXPECT_LE((b - b.transpose()).cwiseAbs().maxCoeff(), 1e-13 * b.cwiseAbs().maxCoeff());
  EXPECT_GT(least_eigenvalue(0.5 * (b + b.transpose())), 0.0);
}

TEST(Multigrid, SameBitsForAnyNumberOfThreads) {
  const SparseRows a = cloth_matrix(80);
  std::vector<Positions> found;
  const int before = threads();
  for (int count : {1, 3}) {
    set_threads(count);
    Positions v = Random(1).positions(static_cast<int>(a.rows()), 1.0);
    Multigrid(a).solve(v);
    found.push_back(v);
  }
  set_threads(before);
  EXPECT_EQ(found[0], found[1]);
}

TEST(Aggregation, EveryAggregateHasSeveralMembersAndWeightsSumUpToOne) {
  const SparseRows a = cloth_matrix(40);
  const Aggregation aggregation = aggregate(a);
  std::vector<int> members(static_cast<std::size_t>(aggregation.count), 0);
  for (int number : aggregation.of) {
    ASSERT_NE(number, Aggregation::kNone);
    ++members[static_cast<std::size_t>(number)];
  }
  EXPECT_GE(*std::min_element(members.begin(), members.end()), 2);
  EXPECT_LT(aggregation.count, a.rows() / 5);
  const SparseRows p = smoothed_prolongation(a, aggregation);
  for (int i = 0; i < p.rows(); ++i) {
    double sum = 0.0;
    for (SparseRows::InnerIterator entry(p, i); entry; ++entry) {
      EXPECT_GT(entry.value(), 0.0);
      sum += entry.value();
    }
    EXPECT_NEAR(sum, 1.0, 1e-14);
  }
  const SparseRows r = p.transpose();
  const Eigen::MatrixXd dense(p), coarse(product(r, product(a, p)));
  const Eigen::MatrixXd wanted = dense.transpose() * (a * dense);
  EXPECT_LE((coarse - wanted).cwiseAbs().maxCoeff(), 1e-12 * wanted.cwiseAbs().maxCoeff());
}

TEST(Aggregation, LeavesOutWhatInertiaAloneHolds) {
  ProjectiveSystem system = spring_net(30, 2, 1.0, 1.0);  // 10 g: 400 N/m at 5 ms
  const Aggregation soft = aggregate(projective_matrix(system, kTimeStep));
  EXPECT_EQ(soft.count, 0);
  // So there is nothing for coarser levels, and the cycle is its smoother.
  const Multigrid multigrid(projective_matrix(system, kTimeStep));
  ASSERT_EQ(multigrid.levels().size(), 1u);
  EXPECT_LT(rate_of(multigrid.levels().front().a, multigrid, 5), 0.05);
}

}  // namespace
}  // namespace pliant
