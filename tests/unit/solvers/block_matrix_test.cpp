#include "pliant/solvers/linear/block_matrix.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant::block_matrix_test {
namespace {

constexpr int kParticles = 5, kPinned = 3;

Particles particles() {
  Random random(3);
  Particles result(random.positions(kParticles, 1.0), Eigen::VectorXd::Ones(kParticles));
  result.fix(kPinned);
  return result;
}

/// What an element set may add, in the order of an assembly: scalars where there is nothing else,
/// where a block comes later, and where one is already.
void add_some(double scale, StiffnessMatrix& k) {
  Random random(11);
  const auto add_block = [&](int i, int j) {
    Eigen::Matrix3d block;
    for (int c = 0; c < 3; ++c) block.col(c) = random.vector(scale);
    k.add(i, j, block);
    k.add(j, i, block.transpose());
  };
  k.add_isotropic(0, 1, 2.0 * scale);
  k.add_isotropic(1, 0, 2.0 * scale);
  k.add_isotropic(0, 4, -scale);
  k.add_isotropic(4, 0, -scale);
  for (const int i : {0, 2}) k.add_isotropic(i, i, 3.0 * scale);
  k.add_isotropic(kPinned, 1, scale);
  add_block(0, 1);
  add_block(1, 2);
  add_block(kPinned, 0);
  k.add_isotropic(1, 2, 0.5 * scale);
  k.add_isotropic(2, 1, 0.5 * scale);
  k.add_isotropic(0, 4, 0.25 * scale);
  k.add_isotropic(4, 0, 0.25 * scale);
}

/// The same with the inertia, of what is not pinned.
Eigen::MatrixXd dense(const std::vector<double>& scales,
                      const std::vector<int>& pinned = {kPinned}) {
  DenseStiffness all(kParticles);
  for (const double scale : scales) add_some(scale, all);
  Eigen::MatrixXd result = all.matrix;
  for (const int i : pinned) {
    result.middleRows<3>(3 * i).setZero();
    result.middleCols<3>(3 * i).setZero();
  }
  result.diagonal().array() += 7.0;
  return result;
}

void assemble(const Particles& particles, const std::vector<double>& scales, BlockMatrix& matrix) {
  do {
    matrix.begin(particles, Eigen::VectorXd::Constant(kParticles, 7.0));
    for (const double scale : scales) add_some(scale, matrix);
  } while (!matrix.finish());
}

void expect_product(const BlockMatrix& matrix, const Eigen::MatrixXd& wanted) {
  const Eigen::Matrix3Xd v = Random(5).positions(kParticles, 1.0);
  Eigen::Matrix3Xd y;
  matrix.multiply(v, y);
  const Eigen::VectorXd exact = wanted * v.reshaped();
  EXPECT_NEAR((y.reshaped() - exact).norm(), 0.0, 1e-14 * exact.norm());
}

TEST(BlockMatrix, MultipliesByBlocksAndByScalars) {
  const Particles p = particles();
  BlockMatrix matrix;
  assemble(p, {1.0}, matrix);
  expect_product(matrix, dense({1.0}));
  // Places that are known, other values; and more of them than before.
  assemble(p, {-2.0}, matrix);
  expect_product(matrix, dense({-2.0}));
  assemble(p, {1.0, 4.0}, matrix);
  expect_product(matrix, dense({1.0, 4.0}));
}

TEST(BlockMatrix, FollowsParticlesThatArePinnedAndReleased) {
  Particles p = particles();
  BlockMatrix matrix;
  assemble(p, {1.0}, matrix);
  p.fix(4);  // whose only entries are scalars
  assemble(p, {1.0}, matrix);
  expect_product(matrix, dense({1.0}, {kPinned, 4}));
  p.release(4);
  p.release(kPinned);
  assemble(p, {1.0}, matrix);
  expect_product(matrix, dense({1.0}, {}));
}

TEST(BlockMatrix, TellsEachEntryOnce) {
  const Particles p = particles();
  BlockMatrix matrix;
  assemble(p, {1.0}, matrix);
  Eigen::MatrixXd told = Eigen::MatrixXd::Zero(3 * kParticles, 3 * kParticles);
  int entries = 0;
  for (int i = 0; i < kParticles; ++i) {
    std::vector<int> columns;
    matrix.for_columns(i, [&](int column) {
      columns.push_back(column);
      return true;
    });
    EXPECT_TRUE(std::is_sorted(columns.begin(), columns.end()));
    std::vector<int> of_blocks;
    matrix.for_blocks(i, [&](int column, const Eigen::Matrix3d& block) {
      of_blocks.push_back(column);
      told.block<3, 3>(3 * i, 3 * column) += block;
    });
    std::sort(of_blocks.begin(), of_blocks.end());
    EXPECT_EQ(columns, of_blocks);
    entries += static_cast<int>(columns.size());
  }
  EXPECT_EQ(entries, matrix.entries());
  EXPECT_EQ(told, dense({1.0}));
  // The diagonal, 0 to 1 and 1 to 2 both ways, and 0 to 4 as scalars.
  EXPECT_EQ(entries, kParticles + 4 + 2);
  EXPECT_EQ(matrix.work(), 9.0 * (kParticles + 4) + 3.0 * 2);
}

}  // namespace
}  // namespace pliant::block_matrix_test
