#include <gtest/gtest.h>

#include "pliant/core/system/constraint.h"

namespace pliant {
namespace {

TEST(ConstraintRows, BeginEmpty) {
  const ConstraintRows rows;
  EXPECT_EQ(rows.size(), 0);
  EXPECT_TRUE(rows.are_met());
}

TEST(ConstraintRows, KeepWhatTheyAreGiven) {
  ConstraintRows rows;
  rows.begin_row(0.0, 0.25);
  rows.add(3, {1.0, 0.0, 0.0});
  rows.add(7, {0.0, -2.0, 0.0});
  rows.begin_row(0.0, 0.0);
  rows.begin_row(0.0, 4.0);
  rows.add(1, {0.0, 0.0, 1.0});
  ASSERT_EQ(rows.size(), 3);
  EXPECT_EQ(rows.compliance(0), 0.25);
  EXPECT_EQ(rows.compliance(2), 4.0);
  ASSERT_EQ(rows.end(0) - rows.begin(0), 2);
  EXPECT_EQ(rows.begin(0)[1].particle, 7);
  EXPECT_EQ(rows.begin(0)[1].gradient, Eigen::Vector3d(0.0, -2.0, 0.0));
  EXPECT_EQ(rows.end(1) - rows.begin(1), 0);
  ASSERT_EQ(rows.end(2) - rows.begin(2), 1);
  EXPECT_EQ(rows.begin(2)->particle, 1);
}

TEST(ConstraintRows, AreMetWhereAllTargetsAreZero) {
  ConstraintRows rows;
  rows.begin_row(0.0, 0.0);
  EXPECT_TRUE(rows.are_met());
  rows.begin_row(-0.5, 0.0);
  rows.begin_row(0.0, 0.0);
  EXPECT_FALSE(rows.are_met());
  EXPECT_EQ(rows.target(0), 0.0);
  EXPECT_EQ(rows.target(1), -0.5);
}

TEST(ConstraintRows, ClearForgetsEverything) {
  ConstraintRows rows;
  rows.begin_row(1.0, 2.0);
  rows.add(0, {1.0, 0.0, 0.0});
  rows.clear();
  EXPECT_EQ(rows.size(), 0);
  EXPECT_TRUE(rows.are_met());
  rows.begin_row(0.0, 0.0);
  rows.add(5, {0.0, 1.0, 0.0});
  ASSERT_EQ(rows.end(0) - rows.begin(0), 1);
  EXPECT_EQ(rows.begin(0)->particle, 5);
}

TEST(ConstraintRows, OfNothingAreAnEmptyRange) {
  ConstraintRows rows;
  rows.begin_row(0.0, 0.0);
  EXPECT_EQ(rows.begin(0), rows.end(0));
}

}  // namespace
}  // namespace pliant
