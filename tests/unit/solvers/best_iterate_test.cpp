#include "pliant/solvers/iterations/best_iterate.h"

#include <gtest/gtest.h>

namespace pliant::best_iterate_test {
namespace {

PointConstraints pressed_with(double force) {
  PointConstraints constraints;
  PointConstraint& constraint = constraints.append();
  constraint.normal_force = force;
  constraint.friction_force = Eigen::Vector3d(0.5 * force, 0.0, 0.0);
  return constraints;
}

TEST(BestIterate, GoesBackToWhatLeftLeast) {
  BestIterate best;
  best.offer(3.0, 0.3, Positions::Constant(3, 2, 1.0), pressed_with(1.0));
  best.offer(1.0, 0.1, Positions::Constant(3, 2, 2.0), pressed_with(2.0));
  best.offer(2.0, 0.2, Positions::Constant(3, 2, 3.0), pressed_with(3.0));
  EXPECT_FALSE(best.is_far_better_than(9.0));
  ASSERT_TRUE(best.is_far_better_than(11.0));
  Positions x = Positions::Zero(3, 2);
  PointConstraints constraints = pressed_with(1e9);
  best.restore(x, constraints);
  EXPECT_EQ(x, Positions::Constant(3, 2, 2.0));
  EXPECT_EQ(constraints.all[0].normal_force, 2.0);
  EXPECT_EQ(constraints.all[0].friction_force.x(), 1.0);
  EXPECT_EQ(best.residual(), 0.1);
}

TEST(BestIterate, KnowsNothingBetterAtFirst) {
  BestIterate best;
  EXPECT_FALSE(best.is_far_better_than(1e30));
  best.offer(std::numeric_limits<double>::quiet_NaN(), 0.0, Positions::Zero(3, 1), {});
  EXPECT_FALSE(best.is_far_better_than(1e30));
  best.offer(1.0, 0.0, Positions::Zero(3, 1), {});
  EXPECT_TRUE(best.is_far_better_than(1e30));
  best.forget();
  EXPECT_FALSE(best.is_far_better_than(1e30));
}

}  // namespace
}  // namespace pliant::best_iterate_test
