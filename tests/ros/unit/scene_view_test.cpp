#include "pliant/ros/markers/scene_view.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "pliant/math/error.h"
#include "pliant/scene/scene.h"

namespace pliant {
namespace {

/// Of a sheet from (0.9, -0.2, 0.5) to (1.1, 0.2, 0.5) and `obstacles`.
Eigen::AlignedBox3d bounds_with(const std::string& obstacles) {
  const std::string path = testing::TempDir() + "scene_view_test.yaml";
  std::ofstream(path) << "time_step: 0.01\n"
                         "bodies:\n"
                         "  - name: sheet\n"
                         "    model: cloth\n"
                         "    geometry: {grid: {size: [0.2, 0.4], vertices: [3, 5]}}\n"
                         "    position: [1, 0, 0.5]\n"
                         "obstacles: [{name: table, shape: plane}"
                      << obstacles << "]\n";
  const Eigen::AlignedBox3d bounds = scene_bounds(load_scene(path));
  std::remove(path.c_str());
  return bounds;
}

YAML::Node view_of(const std::string& configuration, const Eigen::AlignedBox3d& bounds) {
  return YAML::Load(
      framed_configuration(configuration, bounds))["Visualization Manager"]["Views"]["Current"];
}

const char* const kConfiguration =
    "Visualization Manager:\n"
    "  Views:\n"
    "    Current: {Class: rviz/Orbit, Distance: 7, Focal Point: {X: 1, Y: 2, Z: 3}, Yaw: 0.9}\n";

TEST(SceneView, ShowsBodiesWithoutThePlaneThatTheyLieOn) {
  const Eigen::AlignedBox3d bounds = bounds_with("");
  EXPECT_TRUE(bounds.min().isApprox(Eigen::Vector3d(0.9, -0.2, 0.5), 1e-9)) << bounds.min();
  EXPECT_TRUE(bounds.max().isApprox(Eigen::Vector3d(1.1, 0.2, 0.5), 1e-9)) << bounds.max();
}

TEST(SceneView, ShowsObstaclesThatAreNotMuchLarger) {
  const Eigen::AlignedBox3d bounds = bounds_with(
      ", {name: ball, shape: sphere, radius: 0.1, position: [1, 0, 0.2]}"
      ", {name: hall, shape: box, size: [20, 20, 0.1], position: [0, 0, -1]}");
  EXPECT_NEAR(bounds.min().z(), 0.1, 1e-9);
  EXPECT_NEAR(bounds.max().x(), 1.1, 1e-9);
}

TEST(SceneView, MovesTheCameraSoFarThatABallIsSeen) {
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.6, 0.8, 0));
  const YAML::Node view = view_of(kConfiguration, bounds);
  EXPECT_NEAR(view["Focal Point"]["X"].as<double>(), 0.3, 1e-9);
  EXPECT_NEAR(view["Focal Point"]["Y"].as<double>(), 0.4, 1e-9);
  EXPECT_NEAR(view["Focal Point"]["Z"].as<double>(), 0.0, 1e-9);
  // 0.4 m, four fifths of the ball's radius, fill half of the 45 degrees that it sees.
  EXPECT_NEAR(view["Distance"].as<double>() * std::sin(M_PI / 8), 0.4, 1e-9);
  EXPECT_EQ(view["Yaw"].as<double>(), 0.9);
}

TEST(SceneView, RefusesConfigurationsWithoutAViewThatOrbits) {
  const Eigen::AlignedBox3d bounds(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  EXPECT_THROW(framed_configuration("Panels: []\n", bounds), InputError);
  EXPECT_THROW(framed_configuration("[", bounds), InputError);
}

}  // namespace
}  // namespace pliant
