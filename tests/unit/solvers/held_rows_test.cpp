#include "pliant/solvers/constrained/held_rows.h"

#include <gtest/gtest.h>

#include "pliant/solvers/checks/rigid_balance.h"
#include "support/random.h"

namespace pliant::held_rows_test {
namespace {

constexpr int kParticles = 12;

/// Of a rigid body's points that touch, of vertices that stick and slide, of an edge between two
/// bodies, and of points of a solid one after another.
HeldRows rows_of_many_kinds() {
  Random random(3);
  HeldRows rows;
  const auto add = [&](int count, std::initializer_list<int> particles) {
    for (int k = 0; k < count; ++k) {
      rows.begin_row(1.0 + 5.0 * std::abs(random.vector(1.0).x()));
      for (const int particle : particles) rows.add(particle, random.vector(1.0));
    }
  };
  add(30, {0, 1, 2, 3});
  add(3, {4});
  add(1, {5});
  add(3, {2, 5, 6, 7});
  add(40, {8, 9});
  rows.begin_row(2.0);  // of pinned particles alone
  add(3, {10, 11, 4, 0});
  return rows;
}

int blocks_of(const HeldRows& rows) {
  int count = 0;
  rows.for_each([](int) {}, [&](const HeldRows::Block&) { ++count; });
  return count;
}

TEST(HeldRows, MakeBlocksOfTheSameParticlesWhereThatIsLessWork) {
  HeldRows rows = rows_of_many_kinds();
  EXPECT_EQ(blocks_of(rows), 0);
  rows.merge();
  std::vector<int> first;
  rows.for_each([](int) {}, [&](const HeldRows::Block& block) { first.push_back(block.first); });
  EXPECT_EQ(first, (std::vector<int>{0, 30, 37}));
  int seen = 0;
  rows.for_each([&](int row) { EXPECT_EQ(row, seen++); },
                [&](const HeldRows::Block& block) {
                  EXPECT_EQ(block.first, seen);
                  seen = block.last;
                });
  EXPECT_EQ(seen, rows.size()) << "each row once, in order";
  rows.clear();
  EXPECT_EQ(blocks_of(rows), 0);
}

TEST(HeldRows, HaveTheSameProductAndDiagonalInBlocks) {
  HeldRows rows = rows_of_many_kinds();
  const Eigen::Matrix3Xd v = Random(5).positions(kParticles, 1.0);
  Eigen::Matrix3Xd one_by_one = Random(6).positions(kParticles, 1.0), merged = one_by_one;
  std::vector<Eigen::Matrix3d> diagonal(kParticles, Eigen::Matrix3d::Identity());
  auto diagonal_of_blocks = diagonal;
  rows.add_product(v, one_by_one);
  rows.add_diagonal(diagonal);
  rows.merge();
  rows.add_product(v, merged);
  rows.add_diagonal(diagonal_of_blocks);
  EXPECT_LT((merged - one_by_one).norm(), 1e-13 * one_by_one.norm());
  for (int i = 0; i < kParticles; ++i) {
    const auto k = static_cast<std::size_t>(i);
    EXPECT_LT((diagonal_of_blocks[k] - diagonal[k]).norm(), 1e-13 * diagonal[k].norm()) << i;
  }
}

TEST(HeldRows, MoveRigidBodiesAlikeInBlocks) {
  Components components;
  // The particles of one body, of another one, and one that something holds.
  components.of = {0, 0, 0, 0, 1, 1, 1, 1, 0, 1, 2, 2};
  components.members = {0, 1, 2, 3, 8, 4, 5, 6, 7, 9, 10, 11};
  components.begins = {0, 5, 10, 12};
  components.held = {false, false, true};
  components.twisted = {false, false, false};
  const Eigen::VectorXd inertia = Eigen::VectorXd::LinSpaced(kParticles, 1.0, 2.0);
  RigidBalance balance;
  balance.prepare(components, inertia);
  ASSERT_TRUE(balance.is_used());
  balance.place(inertia, 1.0, Random(7).positions(kParticles, 1.0));
  HeldRows rows = rows_of_many_kinds();
  Eigen::Matrix3Xd one_by_one = Random(8).positions(kParticles, 1.0), merged = one_by_one;
  balance.factor(rows);
  ASSERT_TRUE(balance.find_motion(one_by_one));
  rows.merge();
  balance.factor(rows);
  ASSERT_TRUE(balance.find_motion(merged));
  EXPECT_LT((merged - one_by_one).norm(), 1e-10 * one_by_one.norm());
}

}  // namespace
}  // namespace pliant::held_rows_test
