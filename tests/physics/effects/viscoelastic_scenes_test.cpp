// What the scenes of model viscoelastic show.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/scene/scene.h"

namespace pliant::viscoelastic_scenes_test {
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

TEST(ViscoelasticScenes, TheRigidBlockSinks) {
  LoadedScene scene = load_ours("liquid_sink.yaml");
  World& world = *scene.world;
  ASSERT_EQ(world.bodies().size(), 1u) << "joined, so that they touch";
  const Particles& p = world.bodies().front().particles();
  const double liquid_density = 1000.0, spacing = 0.0125;
  Eigen::Index first = 0;
  while (p.mass[first] < 1.5 * liquid_density * std::pow(spacing, 3.0)) ++first;
  const Positions rest = p.x.rightCols(p.size() - first);
  ASSERT_GT(rest.cols(), 100);
  run_until(world, 1.2);
  const Positions block = p.x.rightCols(p.size() - first);
  EXPECT_LT(block.row(2).mean(), 0.06) << "it lies at the bottom, on an edge at the most";
  EXPECT_GT(p.x.row(2).minCoeff(), 0.0);
  for (Eigen::Index i = 1; i < block.cols(); i += 5) {
    const double before = (rest.col(i) - rest.col(0)).norm();
    EXPECT_NEAR((block.col(i) - block.col(0)).norm(), before, 0.02 * before) << "rigid";
  }
}

TEST(ViscoelasticScenes, HoneyRunsDownOverTheBall) {
  LoadedScene scene = load_ours("honey_sphere.yaml");
  World& world = *scene.world;
  const Particles& p = world.bodies().front().particles();
  run_until(world, 0.6);
  const Eigen::RowVectorXd from =
      (p.x.colwise() - Eigen::Vector3d(0.0, 0.0, 0.06)).colwise().norm();
  EXPECT_GT(from.minCoeff(), 0.06) << "none is in the ball";
  EXPECT_GT(p.x.row(2).minCoeff(), 0.0) << "or in the table";
  const auto share = [&](auto&& is) {
    int count = 0;
    for (int i = 0; i < p.size(); ++i) count += is(i) ? 1 : 0;
    return static_cast<double>(count) / p.size();
  };
  EXPECT_GT(share([&](int i) { return p.x(2, i) < 0.02; }), 0.1) << "some runs down";
  EXPECT_GT(share([&](int i) { return p.x(2, i) > 0.1; }), 0.1) << "some still covers it";
}

}  // namespace
}  // namespace pliant::viscoelastic_scenes_test
