#include "pliant/models/reduced/elastic_factor.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "unit/models/reduced/stvk_examples.h"

namespace pliant::elastic_factor_test {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

void expect_solved(const Sparse& matrix, double tolerance) {
  const ElasticFactor factor(matrix);
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd x = Eigen::VectorXd::Random(matrix.cols());
    const Eigen::VectorXd found = factor.solve(matrix * x);
    EXPECT_LE((found - x).norm(), tolerance * x.norm());
  }
}

TEST(ElasticFactor, SolvesForASolidThatIsHeld) {
  const StvkBody beam = cantilever({{1.0, 0.1, 0.2}, {12, 2, 3}}, {1e6, 0.3, 1000.0});
  // Its condition is some 1e5.
  expect_solved(beam.rest_stiffness(), 1e-9);
}

TEST(ElasticFactor, SolvesForALooseSolidWithItsMass) {
  const StvkBody block(make_block({{0.6, 0.2, 0.3}, {5, 3, 3}}), {1e6, 0.3, 1000.0}, {}, "block");
  const Sparse matrix = block.rest_stiffness() + 1e4 * block.consistent_mass();
  expect_solved(matrix, 1e-10);
}

TEST(ElasticFactor, SolvesForAnOddNumberOfVertices) {
  const StvkBody block(make_block({{1.0, 1.0, 1.0}, {2, 2, 2}}), {1e6, 0.3, 1000.0}, {}, "block");
  ASSERT_EQ(block.size() / 3 % 2, 1);
  expect_solved(block.rest_stiffness() + 1e4 * block.lumped_mass(), 1e-10);
}

TEST(ElasticFactor, RefusesWhatIsNotPositiveDefinite) {
  const StvkBody block(make_block({{0.6, 0.2, 0.3}, {4, 2, 2}}), {1e6, 0.3, 1000.0}, {}, "block");
  const Sparse indefinite = block.rest_stiffness() - 1e4 * block.consistent_mass();
  EXPECT_THROW(ElasticFactor{indefinite}, InputError);
}

}  // namespace
}  // namespace pliant::elastic_factor_test
