#include <gtest/gtest.h>

#include "pliant/scene/scene.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

SceneSpec read(const std::string& text) {
  const SceneFiles files;
  return read_scene(write_scene(files, text));
}

TEST(ReadScene, ReadsEveryKey) {
  const SceneFiles files;
  const SceneSpec spec = read_scene(write_scene(files, kFullScene));
  EXPECT_EQ(spec.path, files.path("scene.yaml"));
  EXPECT_EQ(spec.name, "test");
  EXPECT_EQ(spec.description, "every key");
  EXPECT_EQ(spec.time_step, 0.005);
  EXPECT_EQ(spec.threads, 1);
  EXPECT_EQ(spec.solver.name, "xpbd");
  EXPECT_EQ(spec.solver.parameters, (ParameterText{{"iterations", "5"}}));
  EXPECT_EQ(spec.solver.where, files.path("scene.yaml") + ":26: solver");
  ASSERT_TRUE(spec.recording.has_value());
  EXPECT_EQ(spec.recording->every, 10);
  EXPECT_EQ(spec.recording->format, FrameFormat::kPly);
  EXPECT_EQ(spec.limits.max_speed, 1000.0);
  EXPECT_EQ(spec.limits.max_distance, 100.0);
  ASSERT_EQ(spec.robots.size(), 1u);
  EXPECT_EQ(spec.robots[0].urdf_path, files.path("robot.urdf"));
  EXPECT_EQ(spec.robots[0].keyframes_path, files.path("motion.yaml"));
  EXPECT_EQ(spec.robots[0].world_from_base.translation().z(), 2.0);
  EXPECT_EQ(spec.robots[0].initial.at("lift").value, 0.1);
  EXPECT_EQ(spec.robots[0].initial.at("lift").place.line, 21);
}

TEST(ReadScene, ReadsBodies) {
  const SceneSpec spec = read(kFullScene);
  ASSERT_EQ(spec.bodies.size(), 1u);
  const BodySpec& body = spec.bodies[0];
  EXPECT_EQ(body.name, "towel");
  EXPECT_EQ(body.place.line, 5);
  EXPECT_EQ(body.model.name, "cloth");
  EXPECT_EQ(body.model.parameters.at("areal_density"), "0.2");
  EXPECT_EQ(body.geometry.grid->width, 1.0);
  EXPECT_EQ(body.geometry.grid->height, 2.0);
  EXPECT_EQ(body.geometry.grid->columns, 4);
  EXPECT_EQ(body.geometry.grid->rows, 5);
  EXPECT_EQ(body.world_from_body.translation(), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(body.color, Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  ASSERT_EQ(body.fixed.size(), 1u);
  EXPECT_EQ(body.fixed[0].kind, RegionSpec::Kind::kCorner);
}

TEST(ReadScene, ReadsEveryWayToFix) {
  const SceneSpec spec = read(replaced(
      kFullScene, "[{corner: lower_left}]",
      "[{corner: upper_right}, {vertices: [0, 3]}, {box: {min: [0, 0, 0], max: [1, 1, 2]}}]"));
  const auto& fixed = spec.bodies[0].fixed;
  ASSERT_EQ(fixed.size(), 3u);
  EXPECT_TRUE(fixed[0].corner_right);
  EXPECT_TRUE(fixed[0].corner_top);
  EXPECT_EQ(fixed[1].vertices, (std::vector<int>{0, 3}));
  EXPECT_EQ(fixed[2].box.max(), Eigen::Vector3d(1, 1, 2));
}

TEST(ReadScene, ReadsMeshBodies) {
  const SceneFiles files;
  const SceneSpec spec = read_scene(
      write_scene(files, replaced(replaced(kFullScene, "{grid: {size: [1, 2], vertices: [4, 5]}}",
                                           "{mesh: shirts/a.obj, scale: 0.01}"),
                                  "[{corner: lower_left}]", "[{vertices: [0]}]")));
  EXPECT_FALSE(spec.bodies[0].geometry.grid.has_value());
  EXPECT_EQ(spec.bodies[0].geometry.path, files.path("shirts/a.obj"));
  EXPECT_EQ(spec.bodies[0].geometry.options.number("scale"), 0.01);
}

TEST(ReadScene, ReadsEveryShape) {
  const SceneFiles files;
  const SceneSpec spec = read_scene(write_scene(
      files, replaced(kFullScene, "  - {name: ball, shape: sphere, radius: 0.1}\n",
                      "  - {name: a, shape: sphere, radius: 1, color: [1, 0, 0, 0.5]}\n"
                      "  - {name: b, shape: box, size: [1, 2, 3]}\n"
                      "  - {name: c, shape: capsule, radius: 1, length: 2, liquid: true}\n"
                      "  - {name: d, shape: cylinder, radius: 3, length: 4}\n"
                      "  - {name: e, shape: mesh, mesh: m.stl, scale: 2, voxel_size: 0.1}\n")));
  ASSERT_EQ(spec.obstacles.size(), 6u);
  EXPECT_EQ(spec.obstacles[0].friction, 0.3);
  EXPECT_FALSE(spec.obstacles[1].friction.has_value());
  EXPECT_EQ(spec.obstacles[1].color, Eigen::Vector4f(1.0f, 0.0f, 0.0f, 0.5f));
  EXPECT_EQ(spec.obstacles[2].size, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(spec.obstacles[3].length, 2.0);
  EXPECT_TRUE(spec.obstacles[3].liquid);
  EXPECT_FALSE(spec.obstacles[2].liquid);
  EXPECT_EQ(spec.obstacles[4].radius, 3.0);
  EXPECT_EQ(spec.obstacles[5].mesh_path, files.path("m.stl"));
  EXPECT_EQ(spec.obstacles[5].scale, 2.0);
  EXPECT_EQ(spec.obstacles[5].voxel_size, 0.1);
}

TEST(ReadScene, RollPitchYawTurnAboutFixedAxes) {
  const SceneSpec spec = read(replaced(kFullScene, "rotation_rpy: [0, 0, 0]",
                                       "rotation_rpy: [1.5707963267948966, "
                                       "0, 1.5707963267948966]"));
  // Roll takes y to z; yaw leaves z.
  const Eigen::Matrix3d r = spec.bodies[0].world_from_body.linear();
  EXPECT_TRUE((r * Eigen::Vector3d::UnitY()).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  EXPECT_TRUE((r * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(ReadScene, PutsEffectsInTheRegistrysOrder) {
  const SceneSpec spec =
      read(replaced(replaced(kFullScene, "  gravity: {acceleration: [0, 0, -9.81]}\n", ""),
                    "  friction: {coefficient: 0.4}\n",
                    "  friction: {coefficient: 0.4}\n  damping:\n  gravity:\n"));
  std::vector<std::string> names;
  for (const NamedParameters& effect : spec.effects) names.push_back(effect.name);
  EXPECT_EQ(names, (std::vector<std::string>{"gravity", "damping", "contact", "friction"}));
  EXPECT_TRUE(spec.effects[0].parameters.empty());
}

TEST(ReadScene, TakesGravityAsShorthand) {
  const SceneSpec spec =
      read(replaced(replaced(kFullScene, "  gravity: {acceleration: [0, 0, -9.81]}\n", ""),
                    "threads: 1", "gravity: [0, 1, 0]"));
  EXPECT_EQ(spec.effects[0].name, "gravity");
  EXPECT_EQ(spec.effects[0].parameters.at("acceleration"), "[0, 1, 0]");
}

TEST(ReadScene, NeedsOnlyFourKeys) {
  const SceneSpec spec = read(
      "time_step: 0.01\nbodies: [{name: a, model: cloth, geometry: {grid: "
      "{size: [1, 1], vertices: [2, 2]}}}]\nsolver: {name: verlet}\n");
  EXPECT_EQ(spec.name, "scene");
  EXPECT_TRUE(spec.effects.empty());
  EXPECT_TRUE(spec.robots.empty());
  EXPECT_FALSE(spec.recording.has_value());
  EXPECT_FALSE(spec.threads.has_value());
}

}  // namespace
}  // namespace pliant
