#include "pliant/geometry/meshing/quadric.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace pliant {
namespace {

Quadric any(Random& random) {
  Quadric q;
  for (int k = 0; k < 10; ++k) q[k] = random(-1, 1);
  return q;
}

TEST(Quadric, GradientIsThatOfTheValue) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const Quadric q = any(random);
    const Eigen::Vector3d p = random.vector(2.0), way = random.vector(1.0);
    // A quadric's central difference is exact but for round-off.
    const double slope = 0.5 * (value(q, p + way) - value(q, p - way));
    EXPECT_NEAR(gradient(q, p).dot(way), slope, 1e-13);
  }
}

TEST(Quadric, IsMovedAndScaled) {
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    const Quadric q = any(random);
    const Eigen::Vector3d origin = random.vector(3.0), p = random.vector(3.0);
    EXPECT_NEAR(value(placed(q, origin, 0.5), p), value(q, (p - origin) / 0.5), 1e-11);
  }
}

}  // namespace
}  // namespace pliant
