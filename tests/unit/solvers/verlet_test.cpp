#include "pliant/solvers/iterations/verlet.h"

#include <gtest/gtest.h>

#include "support/worlds/worlds.h"

namespace pliant {
namespace {

TEST(Verlet, WarnsAboveTheStepThatIsSurelyStable) {
  const auto warnings = [](double dt) {
    ClothScene scene;
    scene.solver = "verlet";
    scene.grid = {0.3, 0.3, 2, 2};
    scene.material = {{"shear", "0"}, {"bending", "0"}};
    scene.time_step = dt;
    auto world = make_world(scene);
    EXPECT_TRUE(world->step());
    return body_of(*world).report.warnings;
  };
  // Each corner weighs a quarter of the cell, 0.15 * 0.09 / 4 kg; its two springs of 250 N/m give
  // row sums of 1000 N/m: h = 2 sqrt(m / 1000).
  const double limit = 2.0 * std::sqrt(0.15 * 0.09 / 4.0 / 1000.0);
  EXPECT_TRUE(warnings(0.999 * limit).empty());
  const auto above = warnings(1.001 * limit);
  ASSERT_EQ(above.size(), 1u);
  EXPECT_NE(above[0].find("unstable_step"), std::string::npos);
  EXPECT_NE(above[0].find("largest step"), std::string::npos);
}

TEST(Verlet, WithoutSpringsAnyStepIsStable) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.time_step = 1.0;
  scene.material = {{"stretch_warp", "0"}, {"stretch_weft", "0"}, {"shear", "0"}, {"bending", "0"}};
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
}

}  // namespace
}  // namespace pliant
