#include "pliant/math/shortest_turn.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(ShortestTurn, TakesOneDirectionToTheOther) {
  const Vector3d from(0.3, -2.0, 1.0), to(5.0, 1.0, 0.2);
  const Eigen::Quaterniond turn = shortest_turn(from, to);
  EXPECT_NEAR((turn * from.normalized() - to.normalized()).norm(), 0.0, 1e-15);
  const double angle = std::acos(from.normalized().dot(to.normalized()));
  EXPECT_NEAR(2.0 * std::acos(turn.w()), angle, 1e-14);
}

TEST(ShortestTurn, EqualDirectionsNeedNone) {
  const Vector3d a(1.0, 2.0, 3.0);
  EXPECT_NEAR(shortest_turn(a, 2.0 * a).vec().norm(), 0.0, 1e-15);
}

TEST(ShortestTurn, OppositeDirectionsAreHalfATurnApart) {
  for (const Vector3d& a : {Vector3d(0.0, 0.0, 1.0), Vector3d(1.0, 2.0, -3.0)}) {
    const Eigen::Quaterniond turn = shortest_turn(a, -a);
    EXPECT_NEAR(turn.norm(), 1.0, 1e-15);
    EXPECT_NEAR((turn * a + a).norm(), 0.0, 1e-14);
  }
}

TEST(ShortestTurn, NearlyOppositeDirectionsKeepTheirAxis) {
  const Vector3d a = Vector3d::UnitX();
  const Vector3d b(-1.0, 1e-5, 0.0);
  const Eigen::Quaterniond turn = shortest_turn(a, b);
  EXPECT_NEAR((turn * a - b.normalized()).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace pliant
