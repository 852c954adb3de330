#include <limits>

#include "pliant/math/error.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/stable_step.h"
#include "support/worlds/snapshot.h"

namespace pliant {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class Failures : public EverySolver {
 protected:
  /// A cloth that lies on a plane, with every effect that could choke on what is not finite.
  ClothScene lying_scene() const {
    ClothScene scene;
    scene.material = soft_material();
    scene.obstacles = {obstacle(Plane())};
    scene.pose = at(0, 0, 0.001);
    scene.effects = {
        {"gravity", {}}, {"damping", {}}, {"air", {}}, {"contact", {}}, {"friction", {}}};
    scene.solver = solver();
    return scene;
  }

  std::unique_ptr<World> lying() const { return make_stable_world(lying_scene()); }

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

// A NaN reaches its neighbours within the step; the message names the one that began with it.
TEST_P(Failures, NaNInAPositionIsCaughtAndNamed) {
  const auto world = lying();
  run_for(*world, 0.02);
  const double good = particles_of(*world).x(2, 24);
  particles_of(*world).x(2, 24) = kNaN;
  expect_undone(*world, "24: was not finite when the step began");
  particles_of(*world).x(2, 24) = good;
  run_for(*world, 0.1);
  EXPECT_TRUE(particles_of(*world).x.allFinite());
}

TEST_P(Failures, NaNInAVelocityIsCaughtAndResetHeals) {
  const auto world = lying();
  const Snapshot first(*world);
  run_for(*world, 0.02);
  particles_of(*world).v(1, 24) = kNaN;
  expect_undone(*world, "24: was not finite when the step began");
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

/// Puts a force that is not a number on one vertex in every tenth step.
class Hiccup final : public Effect {
 public:
  std::string_view name() const override { return "hiccup"; }
  void before_step(Body& body, double) override {
    if (++calls_ % 10 != 0) return;
    auto& system = projective_system(*body.model);
    system.external_forces.col(30).setConstant(kNaN);
  }

 private:
  int calls_ = 0;
};

// Whatever effects and solver keep from step to step, a step that is undone leaves no trace in it:
// the world goes on bit for bit as one without faults.
TEST_P(Failures, UndoneStepsLeaveNoTrace) {
  for (const bool with_air : {false, true}) {
    ClothScene scene = lying_scene();
    if (with_air) {
      scene.effects[2].second = {
          {"volume", "1e-4"}, {"fill_time", "0.1"}, {"permeability", "1e-6"}};
    } else {
      scene.effects.erase(scene.effects.begin() + 2);
      scene.obstacles.push_back(obstacle(Sphere(0.05), at(0.02, 0, 0.03)));
      scene.pose = at(0, 0, 0.09);
    }
    scene.time_step = std::min(1e-3, stable_step(scene));
    const auto world = make_world(scene), clean = make_world(scene);
    body_of(*world).effects.push_back(std::make_unique<Hiccup>());
    int good = 0;
    for (int k = 0; k < 300; ++k) good += world->step() ? 1 : 0;
    EXPECT_EQ(good, 270);
    for (int k = 0; k < good; ++k) ASSERT_TRUE(clean->step());
    Snapshot(*clean).expect_equal(*world);
  }
}

PLIANT_FOR_EVERY_SOLVER(Failures);

}  // namespace
}  // namespace pliant
