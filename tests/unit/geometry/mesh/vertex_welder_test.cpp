#include "pliant/geometry/mesh/vertex_welder.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

TEST(VertexWelder, JoinsEqualPositionsOnly) {
  VertexWelder welder;
  EXPECT_EQ(welder.add({1, 2, 3}), 0);
  EXPECT_EQ(welder.add({1, 2, std::nextafter(3.0, 4.0)}), 1);
  EXPECT_EQ(welder.add({1, 2, 3}), 0);
  EXPECT_EQ(welder.add({0.0, 0, 0}), 2);
  EXPECT_EQ(welder.add({-0.0, 0, 0}), 2);
  ASSERT_EQ(welder.vertices().cols(), 3);
  EXPECT_EQ(welder.vertices().col(0), Eigen::Vector3d(1, 2, 3));
}

TEST(VertexWelder, KeepsOnePositionThatIsNoNumber) {
  VertexWelder welder;
  EXPECT_EQ(welder.add({std::nan(""), 0, 0}), welder.add({std::nan(""), 0, 0}));
  EXPECT_EQ(welder.vertices().cols(), 1);
}

}  // namespace
}  // namespace pliant
