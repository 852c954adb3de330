// Gauss-Seidel sweeps, with as many colours as it takes and with few, against their formulas.
#include "pliant/solvers/iterations/gauss_seidel.h"

#include <gtest/gtest.h>

#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

class SweepOn : public testing::TestWithParam<StepProblem> {
 protected:
  ProjectiveSystem after(const std::string& solver, int count, ParameterText more = {}) const {
    more["iterations"] = std::to_string(count);
    return after_step(GetParam(), solver, more);
  }
  double dt() const { return GetParam().dt; }
};
INSTANTIATE_TEST_SUITE_P(Problems, SweepOn, testing::ValuesIn(step_problems()), problem_name);

/// Of positions of about 0.3 m after one sweep over some dozen neighbours each.
constexpr double kSweepRoundOff = 1e-13;

TEST_P(SweepOn, SolvesTheLowerTriangleInTheOrderOfItsColours) {
  for (const int count : {0, 1, 7}) {
    const ProjectiveSystem before = after("gauss_seidel", count);
    const SparseRows a = projective_matrix(before, dt());
    const VertexColoring coloring = color_vertices(a, before.particles, 0);
    std::vector<int> order;
    for (const auto& color : coloring.colors) order.insert(order.end(), color.begin(), color.end());
    // (L + D) d = r for A in that order.
    const Eigen::Index n = static_cast<Eigen::Index>(order.size());
    const Eigen::MatrixXd dense(a), ordered = dense(order, order);
    const Forces r = unbalanced_after(before, dt());
    const Eigen::MatrixXd right = r(Eigen::all, order).transpose();
    const Eigen::MatrixXd d = ordered.triangularView<Eigen::Lower>().solve(right);
    Positions expected = before.particles.x;
    for (Eigen::Index k = 0; k < n; ++k) {
      expected.col(order[static_cast<std::size_t>(k)]) += d.row(k).transpose();
    }
    const ProjectiveSystem next = after("gauss_seidel", count + 1);
    EXPECT_LE((next.particles.x - expected).cwiseAbs().maxCoeff(), kSweepRoundOff) << count;
  }
}

TEST_P(SweepOn, OverflowMovesLikeJacobiAfterTheColours) {
  for (const int colors : {1, 2, 3}) {
    const ParameterText more{{"colors", std::to_string(colors)}};
    const ProjectiveSystem before = after("hybrid", 2, more);
    const SparseRows a = projective_matrix(before, dt());
    const Eigen::MatrixXd dense(a);
    const VertexColoring coloring = color_vertices(a, before.particles, colors);
    const Forces r = unbalanced_after(before, dt());
    Positions d = Positions::Zero(3, dense.rows());
    for (const auto& color : coloring.colors) {
      for (int i : color) d.col(i) = (r.col(i) - d * dense.col(i)) / dense(i, i);
    }
    Positions all = d;
    for (int i : coloring.overflow) {
      // Its own row sum over the overflow bounds what the others do at the same time.
      double diagonal = dense(i, i);
      for (int j : coloring.overflow) diagonal += j == i ? 0.0 : std::abs(dense(i, j));
      all.col(i) = (r.col(i) - d * dense.col(i)) / diagonal;
    }
    const ProjectiveSystem next = after("hybrid", 3, more);
    EXPECT_LE((next.particles.x - before.particles.x - all).cwiseAbs().maxCoeff(), kSweepRoundOff);
  }
}

TEST_P(SweepOn, EnoughColoursMakeHybridGaussSeidelInAnotherOrder) {
  const StepProblem& problem = GetParam();
  ProjectiveSystem system = problem.make();
  const StepReport report =
      step_of(system, "hybrid", {{"colors", "64"}, {"iterations", "3"}}, problem.dt);
  EXPECT_EQ(metric(report, "overflow"), 0.0);
  system = problem.make();
  const StepReport plain = step_of(system, "gauss_seidel", iterations(3), problem.dt);
  EXPECT_EQ(metric(plain, "overflow"), 0.0);
  EXPECT_LE(metric(plain, "colors"), metric(report, "colors"));
}

TEST(Hybrid, ReportsItsColoursAndOverflow) {
  ProjectiveSystem system = spring_net(50, 4, 100.0, 1.0);
  const StepReport report = step_of(system, "hybrid", {{"colors", "3"}, {"iterations", "1"}}, 0.01);
  EXPECT_EQ(metric(report, "colors"), 3.0);
  EXPECT_GT(metric(report, "overflow"), 0.0);
}

}  // namespace
}  // namespace pliant
