#include "pliant/effects/contact/pinching.h"

#include <gtest/gtest.h>

#include "pliant/core/body/embedded_points.h"

namespace pliant::pinching_test {
namespace {

constexpr double kOffset = 1e-3;  // [m]

std::vector<Obstacle> obstacles() {
  std::vector<Obstacle> all(3);
  all[0].name = "low";
  all[1].name = "high";
  all[2].name = "side";
  return all;
}

/// That keeps a point above, or below, a height [m].
Contact above(int point, double height) {
  Contact contact;
  contact.point = point;
  contact.obstacle = 0;
  contact.normal = Eigen::Vector3d::UnitZ();
  contact.plane = height;
  return contact;
}

Contact below(int point, double height) {
  Contact contact = above(point, -height);
  contact.obstacle = 1;
  contact.normal = -Eigen::Vector3d::UnitZ();
  return contact;
}

std::string told(const std::vector<Contact>& contacts) {
  Pinching pinching(kOffset);
  pinching.look(ContactPoints(nullptr), Positions::Zero(3, 4), contacts, obstacles());
  return pinching.text();
}

TEST(Pinching, NamesBothObstaclesAndTheVertex) {
  const std::string text = told({above(1, 1.5e-3), above(2, 1e-3), below(2, -1.5e-3)});
  EXPECT_NE(text.find("'low' and 'high' come 2 mm closer"), std::string::npos) << text;
  EXPECT_NE(text.find("at vertex 2:"), std::string::npos) << text;
}

TEST(Pinching, CountsVertices) {
  const std::string text =
      told({above(1, 2e-3), above(2, 2e-3), above(3, 1e-3), below(1, -1e-3), below(2, -2e-3)});
  EXPECT_NE(text.find("at 2 vertices, the most at 2:"), std::string::npos) << text;
}

TEST(Pinching, IsNoneWhereThereIsRoom) {
  EXPECT_EQ(told({}), "");
  EXPECT_EQ(told({above(2, 0.9e-3), below(2, -0.9e-3)}), "") << "a grip";
  EXPECT_EQ(told({above(2, 3e-3), below(2, 1e-3)}), "") << "only one is too near";
}

TEST(Pinching, IsNoneOfVerticesApart) { EXPECT_EQ(told({above(1, 2e-3), below(2, -2e-3)}), ""); }

TEST(Pinching, IsNoneBetweenWhatDoesNotOppose) {
  Contact side = above(2, 0.0);
  side.obstacle = 2;
  side.normal = Eigen::Vector3d::UnitX();
  side.plane = 2e-3;
  EXPECT_EQ(told({above(2, 2e-3), side}), "");
}

TEST(Pinching, OfASolidIsBetweenPointsApart) {
  const EmbeddedPoints points(Eigen::Vector4i(0, 1, 2, 3).replicate(1, 3),
                              Eigen::Matrix4Xd::Constant(4, 3, 0.25));
  Pinching pinching(kOffset);
  pinching.look(ContactPoints(&points), Positions::Zero(3, 4), {above(1, 2e-3), below(2, -2e-3)},
                obstacles());
  EXPECT_NE(pinching.text().find("'low' and 'high' come 4 mm closer"), std::string::npos)
      << pinching.text();
  EXPECT_NE(pinching.text().find("at (0, 0, 0) m:"), std::string::npos) << pinching.text();
}

TEST(Pinching, SaysTheSameUntilItIsTwiceAsBad) {
  Pinching pinching(kOffset);
  const auto look = [&](double height) {
    pinching.look(ContactPoints(nullptr), Positions::Zero(3, 4),
                  {above(2, height), below(2, -height)}, obstacles());
    return pinching.text();
  };
  const std::string first = look(1e-3);
  EXPECT_FALSE(first.empty());
  EXPECT_EQ(look(1.7e-3), first);
  EXPECT_EQ(look(0.0), "");
  EXPECT_EQ(look(1.7e-3), first);
  const std::string worse = look(2.5e-3);
  EXPECT_NE(worse, first);
  EXPECT_EQ(look(1e-3), worse);
  pinching.reset();
  EXPECT_EQ(pinching.text(), "");
  EXPECT_EQ(look(1e-3), first);
}

}  // namespace
}  // namespace pliant::pinching_test
