#include <gtest/gtest.h>

#include <string>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "support/meshes/broken_meshes.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr const char* kCloth = R"(time_step: 0.01
bodies:
  - name: cloth
    model: cloth
    geometry: {grid: {size: [0.1, 0.1], vertices: [3, 3]}}
    position: [0, 0, 5]
effects: {contact: {}}
)";

constexpr const char* kTwoMeshes = R"(<robot name="pair">
  <link name="good"><collision><geometry><mesh filename="whole.obj"/></geometry></collision></link>
  <joint name="j" type="fixed"><parent link="good"/><child link="bad"/></joint>
  <link name="bad"><collision><geometry><mesh filename="holes.obj"/></geometry></collision></link>
  <joint name="k" type="fixed"><parent link="good"/><child link="ball"/></joint>
  <link name="ball"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
</robot>
)";

class Colliders : public ::testing::Test {
 protected:
  Colliders() {
    write_obj(files_.path("whole.obj"), fine_bracket());
    write_obj(files_.path("holes.obj"), with_holes(fine_bracket(), 0.04, 2));
    TriangleMesh sheet = fine_bracket();
    sheet.triangles = Eigen::Matrix3Xi(sheet.triangles.leftCols(60));
    write_obj(files_.path("sheet.obj"),
              with_triangle(sheet, sheet.triangles(0, 0), sheet.triangles(2, 0), 50));
    files_.write("pair.urdf", kTwoMeshes);
  }
  LoadedScene load(const std::string& rest) const {
    return load_scene(files_.write("scene.yaml", kCloth + rest));
  }
  void refuse(const std::string& rest, const std::vector<std::string>& parts) const {
    expect_refusal([&] { load(rest); }, parts);
  }
  static std::string obstacle(const std::string& mesh, const std::string& options) {
    return "obstacles:\n  - {name: thing, shape: mesh, mesh: " + mesh + ", voxel_size: 0.05" +
           options + "}\n";
  }
  static std::string robot(const std::string& options) {
    return "robot:\n  urdf: pair.urdf\n" + options;
  }
  static bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  SceneFiles files_;
};

TEST_F(Colliders, OfObstaclesAreChosenAndTold) {
  LoadedScene whole = load(obstacle("whole.obj", ""));
  EXPECT_EQ(whole.notes, std::vector<std::string>{"obstacle 'thing': collider exact"});
  EXPECT_EQ(whole.mended_meshes, 0);
  const LoadedScene holes = load(obstacle("holes.obj", ""));
  ASSERT_EQ(holes.notes.size(), 1u);
  EXPECT_TRUE(has(holes.notes[0], "obstacle 'thing': collider repaired (")) << holes.notes[0];
  EXPECT_EQ(holes.mended_meshes, 1);
  EXPECT_TRUE(holes.warnings.empty()) << "to be mended is no reason to warn";
}

TEST_F(Colliders, OfObstaclesCanBeAskedFor) {
  const LoadedScene convex = load(obstacle("holes.obj", ", collider: convex"));
  const Eigen::Vector3d corner(0.6, 0.6, 0.2);
  EXPECT_LT(convex.world->obstacles()[0].shape->distance(corner), 0.0);
  EXPECT_TRUE(has(convex.notes[0], "collider convex")) << convex.notes[0];
  const LoadedScene shell = load(obstacle("whole.obj", ", collider: thick_shell, thickness: 0.15"));
  EXPECT_GT(shell.world->obstacles()[0].shape->distance({0.2, 0.2, 0.2}), 0.0) << "it is hollow";
  EXPECT_TRUE(has(shell.notes[0], "150 mm thick") || has(shell.notes[0], "1.5e+02 mm thick"))
      << shell.notes[0];
  refuse(obstacle("holes.obj", ", collider: exact"),
         {"scene.yaml:9", "obstacle 'thing'", "holes.obj", "needs a closed surface", "open edges"});
  refuse(obstacle("whole.obj", ", collider: convx"), {":9:", "collider", "convx", "convex"});
  refuse(obstacle("whole.obj", ", thickness: -1"), {":9:", "thickness"});
  refuse("obstacles:\n  - {name: b, shape: sphere, radius: 1, collider: convex}\n", {"collider"});
}

TEST_F(Colliders, OfLinksAreToldALineEach) {
  const LoadedScene scene = load(robot(""));
  ASSERT_EQ(scene.notes.size(), 2u) << "a sphere needs no word";
  EXPECT_EQ(scene.notes[0], "robot link good/collision 0: exact");
  EXPECT_TRUE(has(scene.notes[1], "robot link bad/collision 0: repaired (")) << scene.notes[1];
  EXPECT_EQ(scene.mended_meshes, 1);
}

TEST_F(Colliders, OfLinksCanBeAskedForByNameOrAllAtOnce) {
  const LoadedScene one = load(robot("  colliders: {bad: convex}\n"));
  EXPECT_TRUE(has(one.notes[1], "bad/collision 0: convex")) << one.notes[1];
  EXPECT_TRUE(has(one.notes[0], "good/collision 0: exact")) << one.notes[0];
  const LoadedScene all = load(robot("  colliders: convex\n"));
  EXPECT_TRUE(has(all.notes[1], "bad/collision 0: convex")) << all.notes[1];
  EXPECT_TRUE(has(all.notes[0], "good/collision 0: convex")) << all.notes[0];
  refuse(robot("  colliders: {bed: convex}\n"),
         {"robot", "colliders: ", "link with a collision mesh", "'bed'", "bad"});
  refuse(robot("  colliders: {ball: convex}\n"), {"robot", "colliders: ", "'ball'"});
  refuse(robot("  colliders: {bad: hull}\n"), {":10:", "robot.colliders.bad", "hull", "convex"});
  refuse(robot("  colliders: hull\n"), {":10:", "robot.colliders", "hull"});
  refuse(robot("  colliders: {}\n"), {":10:", "robot.colliders", "thick_shell"});
  refuse(robot("  colliders: {bad: exact}\n"), {"link 'bad' collision 0", "open edges"});
}

std::string body(const std::string& model, const std::string& geometry,
                 const std::string& material) {
  return "time_step: 0.01\nbodies:\n  - name: body\n    model: " + model +
         "\n    geometry: {mesh: " + geometry + "}\n    material: {" + material + "}\n";
}

TEST_F(Colliders, BodiesAreFilledFromMendedMeshes) {
  // A wall within and holes: not even a manifold.
  write_obj(files_.path("worse.obj"),
            with_triangle(with_holes(fine_bracket(), 0.03, 2), 0, 1, 200));
  for (const std::string& text :
       {body("patch", "worse.obj, tetrahedra: 300", "young: 1e4, poisson: 0.3, density: 500"),
        body("viscoelastic", "worse.obj, particles: 300", ""), body("rigid", "worse.obj", "")}) {
    const LoadedScene scene = load_scene(files_.write("scene.yaml", text));
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_TRUE(has(scene.notes[0], "body 'body': its mesh was mended: ")) << scene.notes[0];
    EXPECT_TRUE(has(scene.notes[0], "open edges")) << scene.notes[0];
    EXPECT_TRUE(scene.world->step()) << text;
  }
}

TEST_F(Colliders, BodiesOfWhatBoundsNothingAreRefusedWithAllFaults) {
  for (const std::string& text :
       {body("patch", "sheet.obj", "young: 1e4, poisson: 0.3, density: 500"),
        body("viscoelastic", "sheet.obj", ""), body("rigid", "sheet.obj", "")}) {
    expect_refusal([&] { load_scene(files_.write("scene.yaml", text)); },
                   {":5:", "body 'body'", "sheet.obj", "bounds no solid", "open edges",
                    "more than two triangles"});
  }
}

}  // namespace
}  // namespace pliant
