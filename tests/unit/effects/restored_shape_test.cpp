#include "pliant/effects/contact/restored_shape.h"

#include <gtest/gtest.h>

#include <limits>

namespace pliant::restored_shape_test {
namespace {

/// Two particles, of which the first came off by 2e-6 m along x where 4 touched 1.
RestoredShape stuck_once() {
  RestoredShape shape;
  Positions bent = Positions::Zero(3, 2), kept = bent;
  kept(0, 0) = 2e-6;
  shape.begin_step();
  shape.note_bent(bent);
  shape.note_stuck({4, 1});
  shape.note_stuck({2, 1});
  shape.note_stuck({4, 1});
  shape.end_step(kept);
  return shape;
}

TEST(RestoredShape, OwesWhatStuckInTheLastStep) {
  RestoredShape shape = stuck_once();
  EXPECT_TRUE(shape.owes(Positions(3, 2)));
  EXPECT_EQ(shape.by()(0, 0), 2e-6);
  const Eigen::Vector3d by = shape.by().col(0);
  EXPECT_TRUE(shape.owes({4, 1}, by, 1e-4));
  EXPECT_TRUE(shape.owes({2, 1}, by, 1e-4));
  EXPECT_FALSE(shape.owes({1, 4}, by, 1e-4));
  shape.begin_step();
  shape.note_bent(Positions::Zero(3, 2));
  shape.end_step(Positions::Zero(3, 2));
  EXPECT_FALSE(shape.owes({4, 1}, by, 1e-4));
}

TEST(RestoredShape, OwesNothingThatNoSolverBends) {
  const RestoredShape shape = stuck_once();
  EXPECT_FALSE(shape.owes({4, 1}, shape.by().col(0), 1e-6));
  EXPECT_FALSE(
      shape.owes({4, 1}, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), 1.0));
  EXPECT_FALSE(shape.owes(Positions(3, 3)));
}

TEST(RestoredShape, StepsWithoutAShapeToGetBackOweNothing) {
  RestoredShape shape = stuck_once();
  // A step on a GPU does not even begin here.
  EXPECT_FALSE(shape.has_bent());
  shape.end_step(Positions::Zero(3, 2));
  EXPECT_FALSE(shape.owes(Positions(3, 2)));
}

TEST(RestoredShape, AnUndoneStepLeavesWhatWasOwed) {
  RestoredShape shape = stuck_once();
  shape.begin_step();
  shape.note_bent(Positions::Zero(3, 2));
  shape.end_step(Positions::Ones(3, 2));
  shape.undo_step();
  EXPECT_TRUE(shape.owes({4, 1}, shape.by().col(0), 1e-4));
  EXPECT_EQ(shape.by()(0, 0), 2e-6);
  shape.reset();
  EXPECT_FALSE(shape.owes(Positions(3, 2)));
}

TEST(RestoredShape, IsSaved) {
  const RestoredShape shape = stuck_once();
  StateArchive numbers;
  shape.save(numbers);
  RestoredShape same;
  numbers.rewind();
  same.load(numbers);
  EXPECT_EQ(numbers.left(), 0u);
  EXPECT_EQ(same.by(), shape.by());
  EXPECT_TRUE(same.owes({4, 1}, shape.by().col(0), 1e-4));
}

}  // namespace
}  // namespace pliant::restored_shape_test
