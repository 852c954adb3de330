// Hard cases of contact and air.
#include <gtest/gtest.h>

#include "support/bounds.h"
#include "support/random.h"
#include "support/shapes.h"
#include "support/tent.h"

namespace pliant {
namespace {

class HardContact : public EverySolver {
 protected:
  ClothScene on_plane(double height) const {
    ClothScene s;
    s.solver = GetParam();
    s.time_step = good_step(GetParam());
    s.obstacles = {obstacle(Plane())};
    s.pose = at(0, 0, height);
    s.effects = {{"gravity", {}}, {"damping", {}}, {"contact", {}}, {"friction", {}}};
    return s;
  }
  int steps(double seconds) const { return static_cast<int>(seconds / good_step(GetParam())); }
};
PLIANT_FOR_EVERY_SOLVER(HardContact);

TEST_P(HardContact, LaidExactlyAtItsDistanceItStays) {
  auto world = make_world(on_plane(0.001));
  const Positions start = particles_of(*world).x;
  run_for(*world, 0.3);
  EXPECT_LE((particles_of(*world).x - start).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(HardContact, LaidExactlyOnTheSurfaceItIsRaised) {
  auto world = make_world(on_plane(0.0));
  for (int k = 0; k < steps(0.3); ++k) {
    ASSERT_TRUE(world->step());
    // Pushed out at 1 m/s at the most, and no springing up afterwards.
    ASSERT_LE(particles_of(*world).x.row(2).maxCoeff(), 0.001 + 1.0 * world->time_step() + 1e-9);
  }
  EXPECT_NEAR(particles_of(*world).x.row(2).minCoeff(), 0.001, 1e-9);
}

TEST_P(HardContact, DeepInsideItComesOut) {
  auto world = make_world(on_plane(-0.1));
  expect_bounded(*world, steps(1.0), 0.5);
  EXPECT_GE(particles_of(*world).x.row(2).minCoeff(), 0.001 - 1e-9);
}

TEST_P(HardContact, StartsThroughEveryPrimitive) {
  for (const char* shape : {"sphere", "box", "capsule", "cylinder"}) {
    ClothScene s = on_plane(0.0);
    s.obstacles[0].shape = primitive(shape);
    auto world = make_world(s);
    for (int k = 0; k < steps(0.5); ++k) ASSERT_TRUE(world->step()) << shape;
    for (int i = 0; i < 49; ++i) {
      EXPECT_GE(s.obstacles[0].shape->distance(particles_of(*world).x.col(i)), 0.001 - 1e-6) << shape;
    }
  }
}

TEST_P(HardContact, BetweenTwoObstaclesThatOverlap) {
  ClothScene s = on_plane(0.001);
  s.obstacles.push_back(obstacle(Box(Eigen::Vector3d(0.5, 0.5, 0.1)), at(0, 0, 0.0505)));
  auto world = make_world(s);
  // No place satisfies both; it must not blow up.
  expect_bounded(*world, steps(0.3), 0.5);
}

TEST_P(HardContact, HitByABoxAtTenMetresASecond) {
  auto world = make_world(on_plane(0.1));
  class Hammer final : public ObstacleDriver {
   public:
    void drive(double time, std::vector<Obstacle>& obstacles) override {
      obstacles[0].pose_end = at(0, 0, std::min(10.0 * time, 1.0));
    }
  };
  world->add_driver(std::make_unique<Hammer>());
  for (int k = 0; k < steps(0.3); ++k) {
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    const double top = world->obstacles()[0].pose_end.translation().z();
    ASSERT_GE(particles_of(*world).x.row(2).minCoeff(), top + 0.001 - 1e-8);
  }
}

TEST_P(HardContact, FastLiftWithAndWithoutAir) {
  const double dt = GetParam() == "verlet" ? 1.0 / 12000 : 1e-3;
  for (const double volume : {0.0, 4e-4}) {
    for (const bool seal_breaks : {false, true}) {
      Tent tent(GetParam(), dt, volume, {}, seal_breaks);
      // 5 m/s for 6 cm, then held.
      for (int k = 0; k < static_cast<int>(0.1 / dt); ++k) {
        ASSERT_TRUE(tent.lift(k * dt < 0.012 ? 5.0 * dt : 0.0))
            << body_of(tent.world()).report.failure;
        ASSERT_LE(extent(tent.world()), 1.0);
        ASSERT_GE(tent.particles().x.row(2).minCoeff(), Tent::kGround - 1e-8);
      }
    }
  }
}

}  // namespace
}  // namespace pliant
