#include <limits>

#include "pliant/math/error.h"
#include "support/stability_worlds.h"

namespace pliant {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class Failures : public HardCase {
 protected:
  /// A cloth that lies on a plane, with every effect that could choke on what is not finite.
  std::unique_ptr<World> lying() const {
    ClothScene scene;
    scene.material = soft_material();
    scene.obstacles = {obstacle(Plane())};
    scene.pose = at(0, 0, 0.001);
    scene.effects = {
        {"gravity", {}}, {"damping", {}}, {"air", {}}, {"contact", {}}, {"friction", {}}};
    scene.solver = solver();
    return make_stable_world(scene);
  }

  static void expect_undone(World& world, const std::string& vertex) {
    const Snapshot before(world);
    EXPECT_FALSE(world.step());
    before.expect_equal(world);
    const std::string& failure = body_of(world).report.failure;
    EXPECT_NE(failure.find("vertex " + vertex), std::string::npos) << failure;
    EXPECT_NE(failure.find("undone"), std::string::npos) << failure;
  }
};

TEST_P(Failures, ForcesThatAreNotFiniteAreRefused) {
  const auto world = lying();
  run_for(*world, 0.02);
  const Snapshot before(*world);
  for (double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
    AppliedForce force;
    force.force.z() = bad;
    EXPECT_THROW(world->applied_forces().add(force), InputError);
    force.force.setZero();
    force.point.x() = bad;
    EXPECT_THROW(world->applied_forces().add(force), InputError);
  }
  EXPECT_TRUE(world->applied_forces().empty());
  before.expect_equal(*world);
  run_for(*world, 0.02);
}

// A NaN reaches its neighbours within the step; of them all the message names the first.
TEST_P(Failures, NaNInAPositionIsCaughtAndNamed) {
  const auto world = lying();
  run_for(*world, 0.02);
  const double good = particles_of(*world).x(2, 0);
  particles_of(*world).x(2, 0) = kNaN;
  expect_undone(*world, "0:");
  particles_of(*world).x(2, 0) = good;
  run_for(*world, 0.1);
  EXPECT_TRUE(particles_of(*world).x.allFinite());
}

TEST_P(Failures, NaNInAVelocityIsCaughtAndResetHeals) {
  const auto world = lying();
  const Snapshot first(*world);
  run_for(*world, 0.02);
  particles_of(*world).v(1, 0) = kNaN;
  expect_undone(*world, "0:");
  world->reset();
  first.expect_equal(*world);
  run_for(*world, 0.1);
}

// From 1 MN, which ends beyond the speed that a blow-up is told by, to what overflows.
TEST_P(Failures, HugeForcesAreRolledBackWithAMessage) {
  for (double size : {1e6, 1e30, 1e150, 1e308}) {
    const auto world = lying();
    run_for(*world, 0.02);
    AppliedForce force;
    force.force.z() = size;
    force.radius = 10.0;
    force.duration = -1.0;
    world->applied_forces().add(force);
    expect_undone(*world, "0:");
    world->applied_forces().clear();
    run_for(*world, 0.1);
    // It lies on the plane as before: contact has forgotten what was undone.
    EXPECT_GT(particles_of(*world).x.row(2).minCoeff(), 0.0) << size;
    EXPECT_LT(particles_of(*world).x.row(2).maxCoeff(), 0.01) << size;
  }
}

PLIANT_FOR_EVERY_CLOTH_SOLVER(Failures);

}  // namespace
}  // namespace pliant
