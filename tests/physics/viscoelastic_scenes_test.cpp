// What the scenes of model viscoelastic show.
#include <gtest/gtest.h>

#include "pliant/scene/scene.h"

namespace pliant {
namespace {

LoadedScene load_ours(const std::string& name) {
  return load_scene(std::string(PLIANT_SOURCE_DIR) + "/config/scenes/" + name);
}

void run_until(World& world, double time) {
  while (world.time() < time - 1e-9) ASSERT_TRUE(world.step()) << world.failure();
}

TEST(ViscoelasticScenes, TheGripperHoldsTheJellyFigure) {
  LoadedScene scene = load_ours("jelly_gripped.yaml");
  World& world = *scene.world;
  EXPECT_TRUE(scene.warnings.empty());
  const Particles& p = world.bodies().front().particles();
  const Positions rest = p.x;
  ASSERT_GT(p.size(), 1500);
  run_until(world, 1.0);
  EXPECT_LT(p.x.row(2).minCoeff(), 0.01) << "it has dropped";
  EXPECT_GT(p.x.row(2).maxCoeff(), 0.07) << "and sits upright";
  run_until(world, 6.0);
  EXPECT_GT(p.x.row(2).minCoeff(), 0.1) << "it is lifted, all of it";
  const Positions held = p.x;
  double carried = 0.0;
  while (world.time() < 7.0 - 1e-9) {
    ASSERT_TRUE(world.step()) << world.failure();
    for (std::size_t o = 0; o < world.obstacles().size(); ++o) {
      if (!world.obstacles()[o].link.empty()) carried -= world.reactions()[o].force.z() / 100.0;
    }
  }
  const double weight = 9.81 * p.mass.sum();
  EXPECT_NEAR(carried, weight, 0.05 * weight) << "by the links alone";
  // A slip of a tenth of a spacing in a second.
  EXPECT_LT((p.x - held).colwise().norm().maxCoeff(), 0.1 * 0.0038) << "and does not slip";
  // Squeezed, but in one piece.
  for (int i = 0; i < p.size(); i += 7) {
    for (int j = 0; j < i; j += 7) {
      const double before = (rest.col(i) - rest.col(j)).norm();
      if (before > 0.02) continue;
      EXPECT_NEAR((p.x.col(i) - p.x.col(j)).norm(), before, 0.5 * before + 0.002);
    }
  }
}

}  // namespace
}  // namespace pliant
