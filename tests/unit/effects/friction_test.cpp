#include "pliant/effects/contact/friction.h"

#include <gtest/gtest.h>

#include "support/worlds/worlds.h"

namespace pliant {
namespace {

class FrictionOfEverySolver : public EverySolver {
 protected:
  /// A cloth that slides over a plane at `speed` along x.
  std::unique_ptr<World> sliding(double speed, const std::string& coefficient,
                                 std::optional<double> of_obstacle = {}) const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    if (GetParam() == "jacobi") s.solver_parameters = {{"iterations", "200"}};
    s.time_step = 1e-3;
    s.obstacles = {obstacle(Plane())};
    s.obstacles[0].friction = of_obstacle;
    s.pose = at(0, 0, 0.001);
    s.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", coefficient}}}};
    auto world = make_world(s);
    particles_of(*world).v.row(0).setConstant(speed);
    return world;
  }
  static double speed(World& world) { return particles_of(world).v.row(0).mean(); }
};
PLIANT_FOR_EVERY_SOLVER(FrictionOfEverySolver);

TEST_P(FrictionOfEverySolver, ForcesStayInTheCone) {
  auto world = sliding(1.0, "0.3");
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(world->step());
    for (const Contact& c : effect_of<ContactEffect>(*world, "contact").contacts()) {
      EXPECT_GE(c.normal_force, 0.0);
      EXPECT_LE(c.friction_force.norm(), 0.3 * c.normal_force * (1.0 + 1e-9));
      EXPECT_NEAR(c.friction_force.dot(c.normal), 0.0, 1e-12 * c.normal_force);
    }
  }
}

TEST_P(FrictionOfEverySolver, SlowsSlidingByMuTimesG) {
  auto world = sliding(1.0, "0.3");
  run_for(*world, 0.1);
  // Constant force: exact in each step but for what iterations leave.
  EXPECT_NEAR(speed(*world), 1.0 - 0.3 * 9.81 * 0.1, 1e-6);
  EXPECT_NEAR(world->reactions()[0].force.x(), 0.3 * 9.81 * particles_of(*world).mass.sum(), 1e-6);
}

TEST_P(FrictionOfEverySolver, StopsAndStays) {
  auto world = sliding(0.1, "0.5");
  run_for(*world, 0.1);
  const Positions stopped = particles_of(*world).x;
  EXPECT_NEAR(speed(*world), 0.0, 1e-9);
  run_for(*world, 0.1);
  EXPECT_LE((particles_of(*world).x - stopped).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(FrictionOfEverySolver, AnObstaclesOwnCoefficientWins) {
  auto world = sliding(1.0, "0.9", 0.1);
  run_for(*world, 0.1);
  EXPECT_NEAR(speed(*world), 1.0 - 0.1 * 9.81 * 0.1, 1e-6);
}

TEST_P(FrictionOfEverySolver, ZeroIsSmooth) {
  auto world = sliding(1.0, "0");
  run_for(*world, 0.1);
  EXPECT_NEAR(speed(*world), 1.0, 1e-11);
}

TEST_P(FrictionOfEverySolver, AConveyorTakesTheClothAlong) {
  auto world = sliding(0.0, "0.5");
  class Conveyor final : public ObstacleDriver {
   public:
    void drive(double time, std::vector<Obstacle>& obstacles) override {
      obstacles[0].pose_end = at(0.2 * time, 0, 0);
    }
  };
  world->add_driver(std::make_unique<Conveyor>());
  run_for(*world, 0.2);
  EXPECT_NEAR(speed(*world), 0.2, 1e-9);
}

}  // namespace
}  // namespace pliant
