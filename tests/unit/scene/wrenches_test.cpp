#include "pliant/scene/robot/wrenches.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {
namespace {

Obstacle wrench_obstacle(const std::string& name, const std::string& link) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.link = link;
  obstacle.shape = std::make_shared<Sphere>(0.1);
  return obstacle;
}

TEST(WrenchAverage, SumsTheShapesOfALinkAboutItsFrame) {
  // Two shapes of one link, whose frame is turned by a quarter about z and lies at (0, 0, 1).
  const Eigen::Isometry3d link =
      Eigen::Translation3d(0.0, 0.0, 1.0) * Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ());
  std::vector<Obstacle> obstacles = {wrench_obstacle("floor", ""), wrench_obstacle("a", "hand"),
                                     wrench_obstacle("b", "hand")};
  for (std::size_t o = 1; o < 3; ++o) {
    obstacles[o].link_from_shape = Eigen::Translation3d(0.0, 0.0, static_cast<double>(o));
    obstacles[o].pose_end = link * obstacles[o].link_from_shape;
  }
  std::vector<Reaction> reactions(3);
  reactions[0].force = {0, 0, -5};
  reactions[1].force = {0, 1, 0};
  reactions[2].force = {0, 1, 0};
  WrenchAverage average(obstacles);
  ASSERT_EQ(average.take().size(), 2u);
  EXPECT_EQ(average.take()[1].force, Eigen::Vector3d::Zero()) << "there before the first contact";
  average.add(obstacles, reactions);
  average.add(obstacles, std::vector<Reaction>(3));
  const std::vector<Wrench> wrenches = average.take();
  EXPECT_EQ(wrenches[0].name, "hand");
  EXPECT_TRUE(wrenches[0].is_robot_link);
  // World's y is the link's x. Mean over two steps of 2 N, at arms of 1 m and 2 m.
  EXPECT_TRUE(wrenches[0].force.isApprox(Eigen::Vector3d(1.0, 0.0, 0.0), 1e-12));
  EXPECT_TRUE(wrenches[0].torque.isApprox(Eigen::Vector3d(0.0, 1.5, 0.0), 1e-12));
  EXPECT_EQ(wrenches[1].name, "floor");
  EXPECT_FALSE(wrenches[1].is_robot_link);
  EXPECT_NEAR(wrenches[1].force.z(), -2.5, 1e-12);
  EXPECT_EQ(average.take()[1].force, wrenches[1].force) << "no step since";
  average.clear();
  EXPECT_EQ(average.take()[1].force, Eigen::Vector3d::Zero());
}

TEST(WrenchAverage, NoTwoHaveTheSameName) {
  const std::vector<Obstacle> obstacles = {wrench_obstacle("hand", ""), wrench_obstacle("hand", ""),
                                           wrench_obstacle("hand/collision 0", "hand")};
  std::vector<std::string> names;
  for (const Wrench& wrench : zero_wrenches(obstacles)) names.push_back(wrench.name);
  EXPECT_EQ(names, (std::vector<std::string>{"hand", "hand_2", "hand_3"}));
}

TEST(Wrench, ColumnsAndCellsGoTogether) {
  std::vector<Wrench> wrenches(2);
  wrenches[0].name = "palm";
  wrenches[0].force = {1.0, 2.0, -0.5};
  wrenches[1].name = "left, lower";
  wrenches[1].torque = {0.0, 0.0, 0.25};
  EXPECT_EQ(wrench_columns(wrenches),
            ",palm.force_x,palm.force_y,palm.force_z,palm.torque_x,palm.torque_y,palm.torque_z"
            ",\"left, lower.force_x\",\"left, lower.force_y\",\"left, lower.force_z\""
            ",\"left, lower.torque_x\",\"left, lower.torque_y\",\"left, lower.torque_z\"");
  EXPECT_EQ(wrench_cells(wrenches), ",1,2,-0.5,0,0,0,0,0,0,0,0,0.25");
  EXPECT_EQ(wrench_columns({}), "");
}

}  // namespace
}  // namespace pliant
