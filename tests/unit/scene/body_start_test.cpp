// Where bodies that touch may not be when a scene begins.
#include <gtest/gtest.h>

#include "support/worlds/body_pairs.h"

namespace pliant::body_start_test {
namespace {

/// What contact says of two bodies at the start.
std::string start_of(const std::string& one, const std::string& other,
                     const std::string& effect = "{}") {
  return refusal(scene_text({one, other}, "  body_contact: " + effect + "\n"));
}

TEST(BodyStart, WhatLiesWithinASolidIsRefused) {
  const std::string ball =
      "  - {name: ball, model: rigid, geometry: {sphere: {radius: 0.01}}, position: [0.01, 0, "
      "0.05]}\n";
  const std::string block = slab("block", "patch", 0.05);
  const std::string text = start_of(ball, block);
  EXPECT_TRUE(has(text,
                  "scene.yaml:6: effects.body_contact: body 'ball' lies within body 'block' "
                  "at the start, at (0.0"))
      << text;
  EXPECT_TRUE(has(text, "move them apart, or let them pass by 'except: [[ball, block]]'")) << text;
  EXPECT_EQ(start_of(ball, block, "{except: [[ball, block]]}"), "");
  EXPECT_TRUE(has(start_of(slab("box", "rigid", 0.05), ball), "'ball' lies within body 'box'"));
  EXPECT_TRUE(has(start_of("  - {name: sheet, model: cloth, geometry: {grid: {size: [0.05, 0.05], "
                           "vertices: [3, 3]}}, position: [0, 0, 0.06]}\n",
                           block),
                  "body 'sheet' lies within body 'block'"));
}

TEST(BodyStart, ParticlesWithinASolidAreCounted) {
  const std::string honey =
      "  - {name: honey, model: viscoelastic, geometry: {block: {size: [0.1, 0.1, 0.1]}, "
      "particles: 1000}, material: {state: liquid, density: 1400}, position: [0, 0, 0.05]}\n";
  const std::string spoon =
      "  - {name: spoon, model: rigid, geometry: {box: {size: [0.03, 0.03, 0.03]}}, position: [0, "
      "0, 0.1]}\n";
  const std::string text = start_of(honey, spoon);
  EXPECT_TRUE(has(text, "vertices or particles of body 'honey' lie within body 'spoon'")) << text;
}

TEST(BodyStart, WhatTouchesASolidFromOutsideIsTaken) {
  EXPECT_EQ(start_of(slab("sheet", "cloth", 0.075), slab("block", "patch", 0.05)), "");
  EXPECT_EQ(start_of(slab("upper", "rigid", 0.1), slab("lower", "rigid", 0.05)), "");
}

TEST(BodyStart, WhatIsInAHollowIsNotWithin) {
  const SceneFiles files;
  // A box with a box in it whose triangles turn to its middle.
  std::string mesh;
  for (const double half : {0.05, 0.04}) {
    for (int k = 0; k < 8; ++k) {
      mesh += fmt::format("v {} {} {}\n", k & 1 ? half : -half, k & 2 ? half : -half,
                          k & 4 ? half : -half);
    }
  }
  const int quads[6][4] = {{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5},
                           {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}};
  for (const auto& q : quads) {
    mesh += fmt::format("f {} {} {}\nf {} {} {}\n", q[0], q[1], q[2], q[0], q[2], q[3]);
    mesh += fmt::format("f {} {} {}\nf {} {} {}\n", q[2] + 8, q[1] + 8, q[0] + 8, q[3] + 8,
                        q[2] + 8, q[0] + 8);
  }
  files.write("shell.obj", mesh);
  const std::string text =
      scene_text({"  - {name: shell, model: rigid, geometry: {mesh: shell.obj}}\n",
                  "  - {name: ball, model: rigid, geometry: {sphere: {radius: 0.02}}}\n"},
                 "  body_contact: {}\n");
  EXPECT_NO_THROW(load_scene(files.write("scene.yaml", text)));
}

}  // namespace
}  // namespace pliant::body_start_test
