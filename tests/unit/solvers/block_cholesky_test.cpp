#include "pliant/solvers/linear/block_cholesky.h"

#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/linear/elimination_tree.h"
#include "support/random.h"

namespace pliant::block_cholesky_test {
namespace {

constexpr int kSide = 20;

/// Of a grid whose nodes are tied to their neighbours.
std::vector<std::pair<int, int>> grid(int rows, int columns) {
  std::vector<std::pair<int, int>> pairs;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int i = r * columns + c;
      if (c + 1 < columns) pairs.emplace_back(i + 1, i);
      if (r + 1 < rows) pairs.emplace_back(i + columns, i);
    }
  }
  return pairs;
}

BlockCholesky::Block random_block(Random& random) {
  BlockCholesky::Block block;
  for (int c = 0; c < 6; ++c) {
    block.col(c) << random.vector(1.0), random.vector(1.0);
  }
  return block;
}

/// A positive definite matrix of that pattern.
struct Problem {
  explicit Problem(const std::vector<std::pair<int, int>>& pairs, int size) {
    Random random(11);
    matrix.analyze(size, pairs);
    matrix.begin();
    dense.setZero(6 * size, 6 * size);
    for (int i = 0; i < size; ++i) add(i, i, 30.0 * BlockCholesky::Block::Identity());
    for (const auto& [row, column] : pairs) add(row, column, random_block(random));
    right.resize(6, size);
    for (int i = 0; i < size; ++i) right.col(i) << random.vector(1.0), random.vector(1.0);
  }
  void add(int row, int column, const BlockCholesky::Block& block) {
    matrix.add(row, column, block);
    dense.block<6, 6>(6 * row, 6 * column) += block;
    if (row != column) dense.block<6, 6>(6 * column, 6 * row) += block.transpose();
  }
  BlockCholesky::Vector solution() {
    EXPECT_TRUE(matrix.factor());
    BlockCholesky::Vector v = right;
    matrix.solve(v);
    return v;
  }
  double residual(const BlockCholesky::Vector& v) const {
    const Eigen::Map<const Eigen::VectorXd> x(v.data(), v.size()), b(right.data(), right.size());
    return (dense * x - b).norm() / b.norm();
  }

  BlockCholesky matrix;
  Eigen::MatrixXd dense;
  BlockCholesky::Vector right;
};

class BlockCholeskyThreads : public ::testing::Test {
 protected:
  void TearDown() override { set_threads(1); }
};

TEST_F(BlockCholeskyThreads, SolveAGridWithTheSameBitsOnAnyNumberOfThem) {
  BlockCholesky::Vector on_one;
  for (const int count : {1, 2, 3, 4}) {
    set_threads(count);
    Problem problem(grid(kSide, kSide), kSide * kSide);
    const BlockCholesky::Vector x = problem.solution();
    EXPECT_LT(problem.residual(x), 1e-13);
    if (count == 1) on_one = x;
    EXPECT_EQ(x, on_one) << count;
  }
}

TEST(BlockCholesky, SolvesChainsPiecesAndLoneBlocks) {
  for (const auto& [pairs, size] :
       std::vector<std::pair<std::vector<std::pair<int, int>>, int>>{{{}, 1},
                                                                     {{}, 5},
                                                                     {grid(1, 40), 40},
                                                                     {grid(2, 2), 4},
                                                                     {{{3, 1}, {7, 5}}, 9},
                                                                     {grid(20, 20), 400}}) {
    Problem problem(pairs, size);
    EXPECT_LT(problem.residual(problem.solution()), 1e-13) << size;
  }
  BlockCholesky none;
  none.analyze(0, {});
  none.begin();
  EXPECT_TRUE(none.factor());
}

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefiniteInAnyColumn) {
  for (const int bad : {0, 37, 210, kSide * kSide - 1}) {
    Problem problem(grid(kSide, kSide), kSide * kSide);
    problem.matrix.add(bad, bad, -100.0 * BlockCholesky::Block::Identity());
    EXPECT_FALSE(problem.matrix.factor()) << bad;
  }
}

/// The rows below the diagonal of a factor of a path 0 - 1 - ... - n-1 that is dissected: its ends
/// first, the middle last.
std::vector<std::vector<int>> two_paths(int half) {
  std::vector<std::vector<int>> columns;
  for (int k = 0; k + 1 < half; ++k) columns.push_back({k + 1});
  columns.push_back({2 * half});
  for (int k = half; k + 1 < 2 * half; ++k) columns.push_back({k + 1});
  columns.push_back({2 * half});
  columns.emplace_back();
  return columns;
}

TEST(EliminationTree, SharesOutWhatKnowsNothingOfEachOther) {
  const EliminationTree::Groups groups = EliminationTree(two_paths(600)).split();
  EXPECT_EQ(groups.first, 600);
  EXPECT_EQ(groups.second, 1200);
  std::vector<bool> is_taken(1201, false);
  for (const int number : groups.number_of) {
    ASSERT_FALSE(is_taken[static_cast<std::size_t>(number)]);
    is_taken[static_cast<std::size_t>(number)] = true;
  }
  for (int k = 0; k + 1 < 600; ++k) {
    EXPECT_LT(groups.number_of[static_cast<std::size_t>(k)],
              groups.number_of[static_cast<std::size_t>(k + 1)]);
  }
  EXPECT_EQ(groups.number_of.back(), 1200);
}

TEST(EliminationTree, LeavesToOneThreadWhatIsAPath) {
  std::vector<std::vector<int>> path(900);
  for (int k = 0; k + 1 < 900; ++k) path[static_cast<std::size_t>(k)] = {k + 1};
  const EliminationTree::Groups groups = EliminationTree(path).split();
  EXPECT_EQ(groups.first, 900);
  EXPECT_EQ(groups.second, 900);
  EXPECT_EQ(EliminationTree({}).split().second, 0);
}

}  // namespace
}  // namespace pliant::block_cholesky_test
