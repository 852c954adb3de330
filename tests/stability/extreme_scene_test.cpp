// Extreme masses, stiffnesses, places and pins.
#include <gtest/gtest.h>

#include "support/bounds.h"
#include "support/random.h"

namespace pliant {
namespace {

class ExtremeScene : public EverySolver {
 protected:
  ClothScene scene() const { return on_two_corners(GetParam(), good_step(GetParam())); }
  int steps(double seconds) const { return static_cast<int>(seconds / good_step(GetParam())); }
};
PLIANT_FOR_EVERY_SOLVER(ExtremeScene);

void set_mass(World& world, int i, double factor) {
  Particles& p = particles_of(world);
  p.mass[i] *= factor;
  p.inverse_mass[i] = 1.0 / p.mass[i];
  world.system_changed();
}

TEST_P(ExtremeScene, OneVertexTenThousandTimesHeavier) {
  auto world = make_world(scene());
  set_mass(*world, 24, 1e4);
  // 3.75 kg pull the cloth far, but no further than free fall in 0.5 s: 1.2 m.
  expect_bounded(*world, steps(0.5), 0.3 + 1.3);
}

TEST_P(ExtremeScene, OneVertexTenThousandTimesLighter) {
  ClothScene s = scene();
  if (GetParam() == "verlet") s.time_step = 2e-6;  // omega grows by 100
  auto world = make_world(s);
  set_mass(*world, 24, 1e-4);
  expect_bounded(*world, GetParam() == "verlet" ? 20000 : steps(0.5), 0.6);
}

TEST_P(ExtremeScene, EverySecondVertexTenThousandTimesHeavier) {
  ClothScene s = scene();
  s.fixed.clear();
  s.obstacles = {obstacle(Plane(), at(0, 0, -0.05))};
  s.effects.push_back({"contact", {}});
  auto world = make_world(s);
  for (int i = 0; i < 49; i += 2) set_mass(*world, i, 1e4);
  expect_bounded(*world, steps(0.5), 0.5);
  EXPECT_GE(particles_of(*world).x.row(2).minCoeff(), -0.05);
}

TEST_P(ExtremeScene, AKilometreFromTheOrigin) {
  const auto result = [&](const Eigen::Vector3d& place) {
    ClothScene s = scene();
    s.pose = Eigen::Isometry3d(Eigen::Translation3d(place + Eigen::Vector3d(0, 0, 0.06)));
    s.obstacles = {obstacle(Plane(), Eigen::Isometry3d(Eigen::Translation3d(place))),
                   obstacle(Sphere(0.04), Eigen::Isometry3d(Eigen::Translation3d(place)))};
    s.effects.push_back({"contact", {}});
    auto world = make_world(s);
    run_for(*world, 0.1);
    return (particles_of(*world).x.colwise() - place).eval();
  };
  // Positions round to 1e-13 m there: over h² / m that is a force of 1e-11 N and more per step.
  const Positions far = result(Eigen::Vector3d(1000, -1000, 0));
  EXPECT_LE((far - result(Eigen::Vector3d::Zero())).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_P(ExtremeScene, OneCornerHoldsAll) {
  ClothScene s = scene();
  s.fixed = {0};
  auto world = make_world(s);
  expect_bounded(*world, steps(1.0), 0.8);
}

TEST_P(ExtremeScene, WithoutShearOrBending) {
  ClothScene s = scene();
  s.material = {{"shear", "0"}, {"bending", "0"}};
  auto world = make_world(s);
  expect_bounded(*world, steps(1.0), 0.6);
}

TEST_P(ExtremeScene, SoftAsNothing) {
  ClothScene s = scene();
  s.material = {{"stretch_warp", "1e-6"}, {"stretch_weft", "1e-6"}, {"shear", "1e-6"}};
  auto world = make_world(s);
  expect_bounded(*world, steps(0.5), 0.3 + 1.3);
}

TEST_P(ExtremeScene, AsLargeAsAFieldAndAsSmallAsAStamp) {
  for (const double size : {100.0, 0.01}) {
    ClothScene s = scene();
    s.grid = {size, size, 7, 7};
    if (size < 0.1) s.time_step = GetParam() == "verlet" ? 1e-6 : 1e-3;
    auto world = make_world(s);
    expect_bounded(*world, 300, 1.5 * size + 0.5 * 9.81);
  }
}

class ImplicitScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, ImplicitScene, testing::Values("xpbd", "jacobi"));

TEST_P(ImplicitScene, StiffAsSteel) {
  ClothScene s = on_two_corners(GetParam(), 1.0 / 60);
  s.material = {{"stretch_warp", "1e9"}, {"stretch_weft", "1e9"}, {"shear", "1e9"}, {"bending", "100"}};
  auto world = make_world(s);
  expect_bounded(*world, 120, 0.6);
}

TEST_P(ImplicitScene, CornerPinsOfAFineCloth) {
  // Few iterations do not carry the weight to the pins: the cloth stretches, and the report says how
  // far from converged it is.
  ClothScene s = on_two_corners(GetParam(), 0.005);
  s.grid = {1.0, 1.0, 60, 60};
  s.fixed = {0, 59};
  s.solver_parameters = {{"iterations", "10"}};
  auto world = make_world(s);
  expect_bounded(*world, 200, 6.0);
  EXPECT_GT(body_of(*world).report.residual, 0.0);
}

TEST(VerletExtreme, StiffAsSteelIsToldAndUndone) {
  ClothScene s = on_two_corners("verlet", 1.0 / 60);
  s.material = {{"stretch_warp", "1e9"}};
  auto world = make_world(s);
  bool good = true;
  for (int k = 0; k < 20 && good; ++k) good = world->step();
  EXPECT_TRUE(warned(*world, "unstable_step"));
  EXPECT_FALSE(good);
  EXPECT_TRUE(particles_of(*world).x.allFinite());
}

}  // namespace
}  // namespace pliant
